/* Before every access of the latch through a pointer an edge may come. */
#ifndef PROOFS_EDGE_AT_ACCESS_H
#define PROOFS_EDGE_AT_ACCESS_H

void edge_at_access(void);

#define AT(pointer) (edge_at_access(), (pointer))

#endif
