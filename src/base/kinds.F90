!> The name of the program, its one real kind and the lengths of its texts.
module kinds
   ! KIND of the Makefile says which of the three: single, double or quad.
   use, intrinsic :: iso_fortran_env, only: wp => REAL_KIND, real32, real64
   implicit none
   private
   public :: program_name, wp, wp_name, exact_power, label_length, title_length

   !> The program and its version.
   character(*), parameter :: program_name = 'KINMAT 2.0'
   !> The name of the kind `wp`.
   character(*), parameter :: wp_name = trim(merge('REAL32 ', merge('REAL64 ', 'REAL128', wp == real64), wp == real32))
   !> The exponent of the largest power of 10 without a rounding error: its power of 5 fits in the digits of `wp`.
   integer, parameter :: exact_power = int(digits(1.0_wp)*(log10(2.0)/log10(5.0)))
   !> Characters of a card's name and of a label: a field of the card.
   integer, parameter :: label_length = 8
   !> Characters of a title: columns 9 to 80.
   integer, parameter :: title_length = 72
end module kinds
