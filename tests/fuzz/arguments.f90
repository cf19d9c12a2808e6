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

   !> A word that is a whole number.
   integer function number(text)
      character(*), intent(in) :: text

      read (text, *) number
   end function number
end module arguments
