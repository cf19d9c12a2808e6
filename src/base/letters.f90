!> Letters, small and capital.
module letters
   implicit none
   private
   public :: capitals

contains

   !> `text` with capitals for small letters of the ASCII alphabet.
   pure function capitals(text) result(upper)
      character(*), intent(in) :: text
      character(len(text)) :: upper
      integer :: i

      upper = text
      do i = 1, len(text)
         if (text(i:i) >= 'a' .and. text(i:i) <= 'z') upper(i:i) = achar(iachar(text(i:i)) - 32)
      end do
   end function capitals
end module letters
