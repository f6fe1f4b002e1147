"""A diagnosis as one page of HTML that needs nothing else; see `skiplatch.report.page`."""
