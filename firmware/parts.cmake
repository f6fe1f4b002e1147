# The parts of the firmware: the core, and extensions that nobody has to take along. Whatever builds
# or packs it reads them here.
set(SKIPLATCH_PARTS core kinematics pretravel transmission injection)
set(SKIPLATCH_core input/*.c report/*.c cycle/touch_cycle.c cycle/overtravel.c)
set(SKIPLATCH_kinematics comp/kinematics*.c cycle/kinematics*.c cycle/sphere_probe.c)
set(SKIPLATCH_pretravel comp/pretravel*.c)
set(SKIPLATCH_transmission comp/transmission*.c comp/pulse_judge.c comp/phase_meter.c transmission/*.c)
set(SKIPLATCH_injection inject/*.c)
