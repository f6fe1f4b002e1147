/*
 * What an RP2040 has and rp2040js has not: core 1, and what there is twice because of it. Core 1 is
 * one more of the emulator's cores, with an interrupt controller and a SysTick of its own, on the
 * same memory and the same peripherals. Here are also the two mailboxes (FIFOs), and the pins'
 * interrupts of core 1.
 *
 * Core 1 waits in its ROM until it has been sent the words that start it; of that ROM there is
 * nothing but those words. The divider and the interpolators of core 1 are not there.
 */
'use strict';

const FIRST_OF_ROM = [0, 0, 1]; // then vectors, stack, entry
const WORDS_OF_ROM = 6;
const MAILBOX_WORDS = 8;
const IRQ_IO_BANK0 = 13;
const SIO = { CPUID: 0x00, GPIO_IN: 0x04, LAST_OF_GPIO: 0x4c, ST: 0x50, WR: 0x54, RD: 0x58 };
const HAS_WORD = 1;
const HAS_ROOM = 2;
const IO_BANK0 = 0x40014;
const PROC1_INTE = 0x130;
const PROC1_INTS = 0x150;
const PINS_OF_REGISTER = 8;
const BITS_OF_PIN = 4;

/* The other end of a core's two mailboxes is `other`. */
class Mailboxes {
  constructor() {
    this.words = [];
    this.other = null;
    this.onWord = null; // who takes the words in place of a program
  }

  read(offset) {
    if (offset === SIO.ST) {
      const room = this.other.words.length < MAILBOX_WORDS ? HAS_ROOM : 0;
      return room | (this.words.length > 0 ? HAS_WORD : 0);
    }
    if (offset !== SIO.RD || this.words.length === 0) {
      throw new Error(`mailbox: nothing to be read at ${offset}`);
    }
    return this.words.shift();
  }

  write(offset, word) {
    const { other } = this;
    if (offset !== SIO.WR || other.words.length === MAILBOX_WORDS) {
      throw new Error(`mailbox: no room for a word at ${offset}`);
    }
    if (other.onWord) {
      other.onWord(word >>> 0);
    } else {
      other.words.push(word >>> 0);
    }
  }
}

const isMailbox = (offset) => offset >= SIO.ST && offset <= SIO.RD;

/* Both cores' pins are the same; the rest of this block each has for itself. */
class SioOfCore1 {
  constructor(sio, mailboxes) {
    this.sio = sio;
    this.mailboxes = mailboxes;
  }

  readUint32(offset) {
    if (offset === SIO.CPUID) {
      return 1;
    }
    return isMailbox(offset) ? this.mailboxes.read(offset) : this.pins(offset).readUint32(offset);
  }

  writeUint32(offset, value) {
    if (isMailbox(offset)) {
      this.mailboxes.write(offset, value);
    } else {
      this.pins(offset).writeUint32(offset, value);
    }
  }

  pins(offset) {
    if (offset < SIO.GPIO_IN || offset > SIO.LAST_OF_GPIO) {
      throw new Error(`core 1 has nothing at ${offset.toString(16)} of the SIO`);
    }
    return this.sio;
  }
}

/* In place of a method of the emulator: `wrapped` is given the one that was there. */
function wrap(object, name, wrapped) {
  object[name] = wrapped(object[name].bind(object));
}

class SecondCore {
  constructor(chip, { CortexM0Core, RPPPB }) {
    this.chip = chip;
    this.core = null; // until it is started
    this.enabled = chip.gpio.map(() => 0); // of the pins' interrupts, for core 1
    this.asked = []; // of the words that start it
    this.classes = { CortexM0Core, RPPPB };
    this.onStart = () => {};
    this.giveMailboxes();
    this.givePins();
  }

  giveMailboxes() {
    const ofCore0 = new Mailboxes();
    const ofCore1 = new Mailboxes();
    [ofCore0.other, ofCore1.other] = [ofCore1, ofCore0];
    ofCore1.onWord = (word) => this.askedBy(word);
    this.mailboxes = ofCore1;
    wrap(this.chip.sio, 'readUint32', (read) => (offset) =>
      isMailbox(offset) ? ofCore0.read(offset) : read(offset));
    wrap(this.chip.sio, 'writeUint32', (write) => (offset, value) =>
      isMailbox(offset) ? ofCore0.write(offset, value) : write(offset, value));
  }

  givePins() {
    const { chip } = this;
    const io = chip.peripherals[IO_BANK0];
    wrap(io, 'readUint32', (read) => (offset) => this.readPins(offset) ?? read(offset));
    wrap(io, 'writeUint32', (write) => (offset, value) =>
      this.enablePins(offset, value) || write(offset, value));
    wrap(chip, 'updateIOInterrupt', (update) => () => {
      update();
      this.updatePins();
    });
    for (const pin of chip.gpio) {
      wrap(pin, 'setInputValue', (set) => (high) => {
        set(high);
        this.updatePins();
      });
    }
    // Lines of peripherals go to both cores, and those of the pins to each its own.
    wrap(chip, 'setInterrupt', (set) => (irq, value) => {
      set(irq, value);
      if (irq !== IRQ_IO_BANK0) {
        this.core?.setInterrupt(irq, value);
      }
    });
  }

  /* The pins of one of four registers from `base` on; undefined if it is none of those. */
  pinsOf(offset, base) {
    const first = ((offset - base) / 4) * PINS_OF_REGISTER;
    return offset >= base && offset < base + 16
      ? this.chip.gpio.slice(first, first + PINS_OF_REGISTER)
      : undefined;
  }

  readPins(offset) {
    const bits = (pins, of) =>
      pins?.reduce((all, pin, at) => all | (of(pin) << (at * BITS_OF_PIN)), 0);
    const enabled = (pin) => this.enabled[pin.index];
    return (
      bits(this.pinsOf(offset, PROC1_INTE), enabled) ??
      bits(this.pinsOf(offset, PROC1_INTS), (pin) => pin.irqStatus & enabled(pin))
    );
  }

  enablePins(offset, value) {
    const pins = this.pinsOf(offset, PROC1_INTE);
    pins?.forEach((pin, at) => {
      this.enabled[pin.index] = (value >>> (at * BITS_OF_PIN)) & 0xf;
    });
    this.updatePins();
    return pins !== undefined;
  }

  updatePins() {
    const asks = this.chip.gpio.some((pin) => pin.irqStatus & this.enabled[pin.index]);
    this.core?.setInterrupt(IRQ_IO_BANK0, asks);
  }

  /* A word has come while core 1 is in its ROM, which sends back each that it expects. */
  askedBy(word) {
    const expected = FIRST_OF_ROM[this.asked.length] ?? word;
    if (word !== expected) {
      throw new Error(`core 1 is asked to start by ${word} in place of ${expected}`);
    }
    this.asked.push(word);
    this.mailboxes.write(SIO.WR, word);
    if (this.asked.length === WORDS_OF_ROM) {
      this.start(...this.asked.slice(FIRST_OF_ROM.length));
    }
  }

  /* For core 1 the chip is as for core 0, but for what each has of its own. */
  start(vectors, stack, entry) {
    const seen = Object.create(this.chip);
    this.core = new this.classes.CortexM0Core(seen);
    seen.core = this.core;
    seen.ppb = new this.classes.RPPPB(seen, 'PPB of core 1');
    seen.sio = new SioOfCore1(this.chip.sio, this.mailboxes);
    Object.assign(this.core, { VTOR: vectors, SP: stack, PC: entry & ~1 });
    this.mailboxes.onWord = null;
    this.updatePins();
    this.onStart(this.core);
  }
}

module.exports = { SecondCore };
