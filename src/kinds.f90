!> Level 1. The one real kind of KINMAT and the sizes of its texts.
module kinds
   implicit none
   private
   public :: wp, wp_name, label_length, title_length

   !> The kind `wp` of every real of the program and its name `wp_name`: by KIND of the Makefile from src/single,
   !> src/double or src/quad.
   include 'wp.inc'
   !> Characters of a card's name and of a label.
   integer, parameter :: label_length = 8
   !> Characters of a title: columns 9 to 80.
   integer, parameter :: title_length = 72
end module kinds
