# The latch beside LinuxCNC's own, in the real LinuxCNC: docs/LINUXCNC.md.

TOUCHES_PER_FEED ?= 20

build/stamps/system-linuxcnc: scripts/setup/system.sh
	@scripts/setup/system.sh linuxcnc || echo 'SKIPPED: no packages of the group linuxcnc to be had here'
	@mkdir -p $(@D) && touch $@

.PHONY: linuxcnc
linuxcnc: setup build/stamps/system-linuxcnc ## the latch beside LinuxCNC's own, on the same touches, as root
	@$(VENV_PYTHON) -m tests.linuxcnc.measure --touches $(TOUCHES_PER_FEED)
