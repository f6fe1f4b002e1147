/*
 * An RP2040 in rp2040js, as a program of this board finds it: its ELF file in flash, a wire from GP3
 * to the trigger pin GP2, a second core once the program starts it, and a clock of virtual time in ns.
 * The cores take turns by the instruction, the one that is due first: none waits for the other's bus.
 *
 * Whatever the program uses that the emulator does not have is an error.
 */
'use strict';

const fs = require('node:fs');
const path = require('node:path');

const EMULATOR = path.resolve(__dirname, '../../../../build/rp2040js/node_modules/rp2040js');
const { GPIOPinState, RP2040 } = require(EMULATOR);
const { CortexM0Core } = require(`${EMULATOR}/dist/cjs/cortex-m0-core.js`);
const { RPPPB } = require(`${EMULATOR}/dist/cjs/peripherals/ppb.js`);
const { SecondCore } = require('./second_core.js');

const CYCLE_NS = 8; // 125 MHz
const FLASH = 0x10000000;
const VECTORS = 0x10000100;
const TRIGGER_PIN = 2;
const DRIVER_PIN = 3;
const AXIS_SLICE = 0;
const FIRST_INTERRUPT = 16; // of the exceptions
const PT_LOAD = 1;

function refuse(component, message) {
  throw new Error(`${component}: ${message}`);
}

const LOGGER = { debug() {}, info() {}, warn: refuse, error: refuse };

/* The parts of an ELF file of 32 bits that are loaded: where to, and what. */
function segmentsOf(elf) {
  const first = elf.readUInt32LE(28);
  const size = elf.readUInt16LE(42);
  const segments = [];
  for (let number = 0; number < elf.readUInt16LE(44); ++number) {
    const header = first + number * size;
    const [type, offset, , address, length] = [0, 4, 8, 12, 16].map((at) =>
      elf.readUInt32LE(header + at),
    );
    if (type === PT_LOAD && length > 0) {
      segments.push({ address, bytes: elf.subarray(offset, offset + length) });
    }
  }
  return segments;
}

class Machine {
  constructor(program) {
    this.chip = new RP2040();
    this.chip.logger = LOGGER;
    this.clock = this.chip.clock;
    this.sent = []; // bytes, by UART 0
    this.stepNs = 0; // of the axis, the last one
    this.cores = []; // that run: how often each has entered which interrupt, and when it is due
    this.ended = false;
    this.chip.uart[0].onByte = (byte) => this.sent.push(byte);
    this.chip.gpio[DRIVER_PIN].addListener((state) => this.setLine(state === GPIOPinState.High));
    this.watchSteps();
    this.add(this.chip.core);
    new SecondCore(this.chip, { CortexM0Core, RPPPB }).onStart = (core) => this.add(core);
    this.load(fs.readFileSync(program));
  }

  setLine(high) {
    this.chip.gpio[TRIGGER_PIN].setInputValue(high);
  }

  /* High or low, at an instant to come. */
  setLineAt(ns, high) {
    this.clock.createAlarm(() => this.setLine(high)).schedule(ns - this.clock.nanos);
  }

  watchSteps() {
    const { pwm } = this.chip;
    const interrupt = pwm.channelInterrupt.bind(pwm);
    pwm.channelInterrupt = (slice) => {
      if (slice === AXIS_SLICE) {
        this.stepNs = this.clock.nanos;
      }
      interrupt(slice);
    };
  }

  /* A core runs from now on. */
  add(core) {
    const added = { core, entered: new Map(), dueNs: this.clock.nanos };
    const enter = core.exceptionEntry.bind(core);
    core.exceptionEntry = (exception) => {
      const interrupt = exception - FIRST_INTERRUPT;
      added.entered.set(interrupt, (added.entered.get(interrupt) ?? 0) + 1);
      enter(exception);
    };
    this.cores.push(added);
  }

  /* What the boot stage does: it starts the program by its vectors. */
  load(elf) {
    const { core, flash } = this.chip;
    for (const { address, bytes } of segmentsOf(elf)) {
      flash.set(bytes, address - FLASH);
    }
    core.VTOR = VECTORS;
    core.SP = this.chip.readUint32(VECTORS);
    core.PC = this.chip.readUint32(VECTORS + 4) & ~1;
  }

  /* Until an instant, or until so many bytes have been sent, or the program has ended. */
  run(untilNs, bytes = Infinity) {
    while (!this.ended && this.clock.nanos < untilNs && this.sent.length < bytes) {
      const first = this.firstDue();
      first.dueNs += first.core.executeInstruction() * CYCLE_NS;
      this.clock.tick(this.firstDue().dueNs - this.clock.nanos);
    }
  }

  firstDue() {
    const [core0, core1] = this.cores;
    return core1?.dueNs < core0.dueNs ? core1 : core0;
  }
}

module.exports = { Machine };
