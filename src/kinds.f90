!> Level 1. The one real kind of KINMAT and the sizes of its texts.
module kinds
   use, intrinsic :: iso_fortran_env, only: real64
   implicit none
   private
   public :: wp, label_length, title_length

   !> Every real of the program.
   integer, parameter :: wp = real64
   !> Characters of a card's name and of a label.
   integer, parameter :: label_length = 8
   !> Characters of a title: columns 9 to 80.
   integer, parameter :: title_length = 72
end module kinds
