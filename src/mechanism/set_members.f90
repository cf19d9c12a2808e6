!> Rows and drives of a set by their numbers in the order of the cards: what they are called and which law a drive has,
!> in whatever part they are.
module set_members
   use kinds, only: label_length
   use mechanism, only: drive_t, request_t
   use independent, only: set_t, request_of
   use names, only: drive_name, subject_name
   use columns, only: form_of
   implicit none
   private
   public :: requests_of, row_form, row_subject, drive_of, drive_number, drive_title

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
end module set_members
