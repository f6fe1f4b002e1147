"""Pictures as SVG files of their own, readable on light and on dark ground."""
