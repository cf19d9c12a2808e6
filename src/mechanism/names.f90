!> Names of links, points, pairs and drives in messages, and lists of names.
module names
   use kinds, only: label_length
   use mechanism, only: mechanism_t, drive_t, drive_words, driven_kinds, drive_relangle, request_link, request_point, &
      request_measure
   use number_format, only: whole
   implicit none
   private
   public :: drive_name, drive_length, subject_name, listed, more

   !> The largest number of names in a list: nobody reads more. All others are only counted.
   integer, parameter :: max_listed_names = 8
   !> The largest number of characters of a list, since drives have long names.
   integer, parameter :: max_list_length = 84

   !> Characters of the name of a drive: three words and two blanks.
   integer, parameter :: drive_length = 3*label_length + 2

contains

   !> Names a drive as on its card: kind, and names of its links, point or pair.
   pure function drive_name(m, drive) result(name)
      type(mechanism_t), intent(in) :: m
      type(drive_t), intent(in) :: drive     !< of `m`
      character(drive_length) :: name

      name = trim(drive_words(drive%kind))//' '//subject_name(m, driven_kinds(drive%kind), drive%subject)
      if (drive%kind == drive_relangle) name = trim(name)//' '//m%links(drive%second)%name
   end function drive_name

   !> Gives the name of a link, point, pair or measure.
   pure function subject_name(m, kind, subject) result(name)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: kind            !< request_link, ..., request_measure
      integer, intent(in) :: subject         !< number of the link, point, pair or measure
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

   !> Lists names with commas between them. Of many names the text has the first ones and the number of the others.
   pure function listed(words, polish) result(text)
      character(*), intent(in) :: words(:)   !< (1 or more) the names
      logical, intent(in) :: polish          !< in Polish; otherwise in English
      character(:), allocatable :: text
      integer :: i

      text = trim(words(1))
      do i = 2, min(size(words), max_listed_names)
         if (len(text) + 2 + len_trim(words(i)) > max_list_length) exit
         text = text//', '//trim(words(i))
      end do
      text = text//more(size(words) - i + 1, polish)
   end function listed

   !> Gives the text that ends an incomplete list of names: ' AND 3 MORE'; '' for a complete list.
   pure function more(n, polish) result(text)
      integer, intent(in) :: n               !< number of names that the list leaves out, 0 or more
      logical, intent(in) :: polish          !< in Polish; otherwise in English
      character(:), allocatable :: text

      text = ''
      if (n == 0) return
      text = ' AND '//whole(n)//' MORE'
      if (polish) text = ' I '//whole(n)//' INNE'
   end function more
end module names
