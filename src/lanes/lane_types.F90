!> What equations are made of, one number a lane.
#define NUMBER real(wp), dimension(width)
#define IS(value)
module lane_types
   use kinds, only: wp
   use lane_sines, only: width
   implicit none
   private
   public :: vector_t, unknown_t, row_numbers_t, loop_numbers_t, loop_state_t

#include "number_types.inc"
end module lane_types
