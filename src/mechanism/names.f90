!> Names of links, points, pairs and drives in messages, and lists of names.
module names
   use kinds, only: label_length
   use mechanism, only: mechanism_t, drive_t, drive_words, driven_kinds, drive_relangle, request_link, request_point, &
      request_measure
   use number_format, only: whole
   implicit none
   private
   public :: drive_name, subject_name, listed, more

   !> The largest number of names in a list, and of its characters; the rest is only counted. Drives have long names.
   integer, parameter :: max_names = 8, max_listed = 84

contains

   !> The kind of `drive` of the mechanism `m` and what it drives, as on its card.
   pure function drive_name(m, drive) result(name)
      type(mechanism_t), intent(in) :: m
      type(drive_t), intent(in) :: drive
      character(3*label_length + 2) :: name

      name = trim(drive_words(drive%kind))//' '//subject_name(m, driven_kinds(drive%kind), drive%subject)
      if (drive%kind == drive_relangle) name = trim(name)//' '//m%links(drive%second)%name
   end function drive_name

   !> The name of the link, point, pair or measure (`kind`, as of a request) with the number `subject`.
   pure function subject_name(m, kind, subject) result(name)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: kind, subject
      character(label_length) :: name

      select case (kind)
      case (request_link)
         name = m%links(subject)%name
      case (request_point)
         name = m%points(subject)%name
      case (request_measure)
         name = m%measures(subject)%name
      case default
         name = m%pairs(subject)%name
      end select
   end function subject_name

   !> The names `words` (at least one) with commas between them; of many, the first ones and the number of the rest, in
   !> Polish or in English.
   pure function listed(words, polish) result(text)
      character(*), intent(in) :: words(:)
      logical, intent(in) :: polish
      character(:), allocatable :: text
      integer :: i

      text = trim(words(1))
      do i = 2, min(size(words), max_names)
         if (len(text) + 2 + len_trim(words(i)) > max_listed) exit
         text = text//', '//trim(words(i))
      end do
      text = text//more(size(words) - i + 1, polish)
   end function listed

   !> The end of a list of which `n` are left out: ' AND 3 MORE'; '' where none are.
   pure function more(n, polish) result(text)
      integer, intent(in) :: n
      logical, intent(in) :: polish
      character(:), allocatable :: text

      text = ''
      if (n == 0) return
      text = ' AND '//whole(n)//' MORE'
      if (polish) text = ' I '//whole(n)//' INNE'
   end function more

end module names
