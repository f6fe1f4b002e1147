/*
 * One run of a program for the bench:
 *
 *   node bench.js PROGRAM
 *
 * Each line of the input is a request, an object in JSON; each has one line for an answer, with what
 * was asked for, the time `now` in ns, and what UART 0 has `sent` since the last answer, in hexadecimal
 * digits. Time passes in `run` alone.
 */
'use strict';

const readline = require('node:readline');
const { Machine } = require('./machine.js');

const machine = new Machine(process.argv[2]);
const { chip, clock } = machine;

const REQUESTS = {
  /* Let so many ns pass, or fewer if so many bytes are sent. */
  run: ({ ns, bytes }) => machine.run(clock.nanos + ns, bytes),
  read: ({ address }) => chip.readUint32(address),
  /* The bytes of a string of hexadecimal digits come in at UART 0. */
  send: ({ digits }) => Buffer.from(digits, 'hex').forEach((byte) => chip.uart[0].feedByte(byte)),
  /* The trigger line is low now, and goes high in so many ns. */
  deflect: ({ ns }) => {
    machine.setLine(false);
    machine.setLineAt(clock.nanos + ns, true);
  },
  /* When the axis has made its last step. */
  step: () => machine.stepNs,
  /* How often a core has entered an interrupt. */
  entered: ({ interrupt, core }) => machine.cores[core].entered.get(interrupt),
};

function answer(line) {
  const request = JSON.parse(line);
  const value = REQUESTS[request.do](request);
  const sent = Buffer.from(machine.sent.splice(0)).toString('hex');
  process.stdout.write(`${JSON.stringify({ value, now: clock.nanos, sent })}\n`);
}

readline.createInterface({ input: process.stdin }).on('line', answer);
