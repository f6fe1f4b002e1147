/* What this board's own files and those shared with other boards agree on. */
#ifndef ATMEGA2560_BOARD_H
#define ATMEGA2560_BOARD_H

#define BOARD_CLOCK_HZ 16000000ul
#define BOARD_BUS_BAUD 500000ul /* TXD on PE1, RXD on PE0 */

#endif
