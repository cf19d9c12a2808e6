!> Rows and drives of a set by their numbers in the order of the cards: what they are called and which law a drive has,
!> in whatever part they are.
module set_members
   use kinds, only: label_length
   use mechanism, only: drive_t, request_t, shown_links
   use independent, only: set_t, request_of
   use names, only: drive_name, subject_name
   use columns, only: form_of
   implicit none
   private
   public :: requests_of, row_form, row_subject, link_of_point, link_names, drive_of, drive_number, drive_title, &
      same_before, has_cylinders

contains

   !> Gives the requests of all rows of a set, in the numbers of their parts.
   pure function requests_of(set) result(requests)
      class(set_t), intent(in) :: set
      type(request_t), allocatable :: requests(:)   !< (rows of the set)
      integer :: i

      requests = [(request_of(set, i), i=1, size(set%rows))]
   end function requests_of

   !> Finds the form of a row.
   pure integer function row_form(set, i)
      class(set_t), intent(in) :: set
      integer, intent(in) :: i               !< number of the row in the set

      row_form = form_of(set%parts(set%rows(i)%part), request_of(set, i))
   end function row_form

   !> Names the link, point, pair or measure of a row.
   pure function row_subject(set, i) result(name)
      class(set_t), intent(in) :: set
      integer, intent(in) :: i               !< number of the row in the set
      character(label_length) :: name

      associate (own => set%parts(set%rows(i)%part), k => set%rows(i)%number)
         name = subject_name(own, own%requests(k)%kind, own%requests(k)%subject)
      end associate
   end function row_subject

   !> Names the link of the point of a row.
   pure function link_of_point(set, i) result(name)
      class(set_t), intent(in) :: set
      integer, intent(in) :: i               !< number of the row in the set
      character(label_length) :: name

      associate (own => set%parts(set%rows(i)%part), k => set%rows(i)%number)
         name = own%links(own%points(own%requests(k)%subject)%link)%name
      end associate
   end function link_of_point

   !> Names links, without the blocks of slots.
   pure function link_names(set, part, links) result(names)
      class(set_t), intent(in) :: set
      integer, intent(in) :: part            !< number of the independent mechanism
      integer, intent(in) :: links(:)        !< numbers of the links there
      character(label_length), allocatable :: names(:)

      associate (own => set%parts(part))
         names = own%links(shown_links(own, links))%name
      end associate
   end function link_names

   !> Tells whether a set has cylinders.
   pure logical function has_cylinders(set)
      class(set_t), intent(in) :: set
      integer :: c

      has_cylinders = any([(any(set%parts(c)%pairs%is_cylinder), c=1, set%count)])
   end function has_cylinders

   !> Gives a drive with its law. Assign the result: gfortran loses the memory of one that is used in an expression.
   pure type(drive_t) function drive_of(set, i)
      class(set_t), intent(in) :: set
      integer, intent(in) :: i               !< number of the drive in the set

      drive_of = set%parts(set%drives(i)%part)%drives(set%drives(i)%number)
   end function drive_of

   !> Finds the number of a drive in the set.
   pure integer function drive_number(set, part, number)
      class(set_t), intent(in) :: set
      integer, intent(in) :: part            !< number of the independent mechanism
      integer, intent(in) :: number          !< number of the drive there

      drive_number = findloc(set%drives%part == part .and. set%drives%number == number, .true., dim=1)
   end function drive_number

   !> Names a drive: its kind and the names of its links, point or pair.
   pure function drive_title(set, i) result(name)
      class(set_t), intent(in) :: set
      integer, intent(in) :: i               !< number of the drive in the set
      character(:), allocatable :: name

      associate (own => set%parts(set%drives(i)%part))
         name = trim(drive_name(own, own%drives(set%drives(i)%number)))
      end associate
   end function drive_title

   !> Counts the drives of its mechanism before a drive that drive the same coordinate.
   pure integer function same_before(set, i) result(count_before)
      class(set_t), intent(in) :: set
      integer, intent(in) :: i               !< number of the drive in the set

      associate (n => set%drives(i)%number, drives => set%parts(set%drives(i)%part)%drives)
         count_before = count(drives(:n - 1)%kind == drives(n)%kind .and. drives(:n - 1)%subject == drives(n)%subject &
            .and. drives(:n - 1)%second == drives(n)%second)
      end associate
   end function same_before
end module set_members
