#include "vectors/tickets.clh"

/* Counts how often each ticket is taken. */
__kernel void take_tickets(__global uint* taken, __global uint* tickets, uint first_ticket,
                          uint ticket_count) {
  for (uint ticket; (ticket = take_ticket(tickets, first_ticket)) < ticket_count;) atomic_inc(taken + ticket);
}
