!> Level 4. How links, pairs and drives are called in messages.
module naming
   use kinds, only: label_length
   use mechanism, only: mechanism_t, drive_t, drive_angle, drive_x, drive_y, drive_relangle
   use numerals, only: whole
   implicit none
   private
   public :: drive_name, listed

   !> So many names are told; of more, the number.
   integer, parameter :: most_names = 8

contains

   !> Kind and subject of a drive, as on its card.
   pure function drive_name(m, d) result(name)
      type(mechanism_t), intent(in) :: m
      type(drive_t), intent(in) :: d
      character(3*label_length + 2) :: name

      select case (d%kind)
      case (drive_angle)
         name = 'ANGLE '//m%links(d%subject)%name
      case (drive_x)
         name = 'X '//m%points(d%subject)%name
      case (drive_y)
         name = 'Y '//m%points(d%subject)%name
      case (drive_relangle)
         name = 'RELANGLE '//trim(m%links(d%subject)%name)//' '//m%links(d%second)%name
      case default
         name = 'SLIDE '//m%pairs(d%subject)%name
      end select
   end function drive_name

   !> Names with commas between them.
   pure function listed(names) result(text)
      character(*), intent(in) :: names(:)
      character(:), allocatable :: text
      integer :: i

      text = trim(names(1))
      do i = 2, min(size(names), most_names)
         text = text//', '//trim(names(i))
      end do
      if (size(names) > most_names) text = text//' AND '//whole(size(names) - most_names)//' MORE'
   end function listed
end module naming
