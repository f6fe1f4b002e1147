# A port begins as a copy of this folder; mk/boards.mk says what can stand here. On a board: its
# family (avr, arm, riscv) and its processor for the compiler, e.g. FLAGS.$(board) := -mmcu=atmega328p
FAMILY.$(board) := host
