!> Vectors, unknowns and numbers of the equations, in reals.
#define NUMBER real(wp)
#define IS(value) = value
module number_types
   use kinds, only: wp
   implicit none
   private
   public :: vector_t, unknown_t, row_numbers_t, loop_numbers_t, link_numbers_t, loop_state_t

#include "number_types.inc"
end module number_types
