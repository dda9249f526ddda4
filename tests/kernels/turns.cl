#include "turns.clh"

/* How often each piece is taken. */
__kernel void take_pieces(__global uint* taken, uint pieces, __global uint* turns,
                          uint first_turn) {
  for (uint piece; (piece = take_turn(turns, first_turn)) < pieces;) atomic_inc(taken + piece);
}
