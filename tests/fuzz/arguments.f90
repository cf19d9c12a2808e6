!> Tests. The words of a command.
module arguments
   implicit none
   private
   public :: argument, number

contains

   !> Word `i` of the command.
   function argument(i) result(text)
      integer, intent(in) :: i
      character(:), allocatable :: text
      integer :: length

      call get_command_argument(i, length=length)
      allocate (character(length) :: text)
      call get_command_argument(i, text)
   end function argument

   !> Word `i` of the command, a whole number; `otherwise` if there is none.
   integer function number(i, otherwise)
      integer, intent(in) :: i
      integer, intent(in), optional :: otherwise
      character(:), allocatable :: text

      text = argument(i)
      if (text /= '') read (text, *) number
      if (text == '') number = otherwise
   end function number
end module arguments
