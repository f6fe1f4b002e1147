/*
 * Runs one suite:
 *
 *   node suite.js SUITE
 *
 * The report comes by semihosting, and so does the exit status; what UART 0 sends is a file `sent`,
 * which the suite reads.
 */
'use strict';

const fs = require('node:fs');
const { Machine } = require('./machine.js');

const SEMIHOSTING = 0xab;
const SENT_HANDLE = 1;
const STDOUT = 1;

const machine = new Machine(process.argv[2]);
const { chip } = machine;

const word = (address) => chip.readUint32(address);

function readSent(argument) {
  const [to, count] = [word(argument + 4), word(argument + 8)];
  const bytes = machine.sent.splice(0, count);
  bytes.forEach((byte, at) => chip.writeUint8(to + at, byte));
  return count - bytes.length;
}

const OPERATIONS = {
  0x01: () => SENT_HANDLE, // open
  0x03: (argument) => fs.writeSync(STDOUT, String.fromCharCode(chip.readUint8(argument))),
  0x06: readSent,
  0x20: (argument) => {
    process.exitCode = word(argument + 4);
    machine.ended = true;
    return 0;
  },
};

chip.onBreak = (number) => {
  const { registers } = chip.core;
  const operation = OPERATIONS[registers[0]];
  if (number !== SEMIHOSTING || operation === undefined) {
    throw new Error(`the program breaks: ${number}, ${registers[0]}`);
  }
  registers[0] = operation(registers[1]);
};

machine.run(Infinity);
