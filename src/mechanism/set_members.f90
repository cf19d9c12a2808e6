!> Rows and drives of a divided set by their numbers in the order of the cards: their names, and the law of a drive, in
!> any part. Links, pairs, drives and tolerances of a part by their numbers in the part.
module set_members
   use kinds, only: wp, label_length
   use mechanism, only: drive_t, request_t, tolerance_t, shown_links, is_fixed
   use motion, only: diagnostic_t
   use independent, only: set_t, request_of
   use names, only: drive_name, subject_name
   use scales, only: characteristic_length, characteristic_rate
   use columns, only: form_of
   implicit none
   private
   public :: requests_of, row_form, row_subject, link_of_point, ratio_drive, moving_extremes, drive_of, drive_number, &
      drive_title, same_before, has_cylinders
   public :: sizes_of, tolerances_of, link_names, name_in, name_of_drive

contains

   !> Gives the requests of all rows of a set, in the numbers of their parts.
   pure function requests_of(set) result(requests)
      class(set_t), intent(in) :: set        !< a divided set
      type(request_t), allocatable :: requests(:)   !< (rows of the set)
      integer :: i

      requests = [(request_of(set, i), i=1, size(set%rows))]
   end function requests_of

   !> Finds the form of a row of a set: row_link, ..., last_form.
   pure integer function row_form(set, i)
      class(set_t), intent(in) :: set        !< a divided set
      integer, intent(in) :: i               !< number of the row in the set

      row_form = form_of(set%parts(set%rows(i)%part), request_of(set, i))
   end function row_form

   !> Names the link, point, pair or measure of a row of a set.
   pure function row_subject(set, i) result(name)
      class(set_t), intent(in) :: set        !< a divided set
      integer, intent(in) :: i               !< number of the row in the set
      character(label_length) :: name

      associate (own => set%parts(set%rows(i)%part), k => set%rows(i)%number)
         name = subject_name(own, own%requests(k)%kind, own%requests(k)%subject)
      end associate
   end function row_subject

   !> Names the link to which the point of a row belongs. The row must be about a point.
   pure function link_of_point(set, i) result(name)
      class(set_t), intent(in) :: set        !< a divided set
      integer, intent(in) :: i               !< number of the row in the set
      character(label_length) :: name

      associate (own => set%parts(set%rows(i)%part), k => set%rows(i)%number)
         name = own%links(own%points(own%requests(k)%subject)%link)%name
      end associate
   end function link_of_point

   !> Finds the drive of a row of ratios: the drive's number among all drives of the set; 0 if the row is no ratio.
   pure integer function ratio_drive(set, i)
      class(set_t), intent(in) :: set        !< a divided set
      integer, intent(in) :: i               !< number of the row in the set
      type(request_t) :: request

      request = request_of(set, i)
      ratio_drive = drive_number(set, set%rows(i)%part, request%drive)
   end function ratio_drive

   !> Finds the numbers (any number) of the rows whose extremes are requested, without rows of the ground, which does
   !> not move.
   pure function moving_extremes(set) result(requested)
      class(set_t), intent(in) :: set        !< a divided set
      integer, allocatable :: requested(:)
      type(request_t) :: requests(size(set%rows))
      integer :: i

      requests = requests_of(set)
      requested = pack([(i, i=1, size(requests))], requests%extremes .and. &
         .not. [(is_fixed(set%parts(set%rows(i)%part), requests(i)), i=1, size(requests))])
   end function moving_extremes

   !> Gives the characteristic length of a part (deck's unit) and its characteristic rate (1 over the unit of time).
   pure function sizes_of(set, part) result(sizes)
      class(set_t), intent(in) :: set        !< a divided set
      integer, intent(in) :: part            !< number of the independent mechanism
      real(wp) :: sizes(2)

      sizes(1) = characteristic_length(set%parts(part))
      sizes(2) = characteristic_rate(set%parts(part), sizes(1))
   end function sizes_of

   !> Gives the tolerances (any number) of a part. Some number of the set must have a tolerance.
   pure function tolerances_of(set, part) result(tolerances)
      class(set_t), intent(in) :: set        !< a divided set
      integer, intent(in) :: part            !< number of the independent mechanism
      type(tolerance_t), allocatable :: tolerances(:)

      tolerances = set%parts(part)%tolerances
   end function tolerances_of

   !> Names links of a part (any number), without the blocks of slots, which have no names.
   pure function link_names(set, part, links) result(names)
      class(set_t), intent(in) :: set        !< a divided set
      integer, intent(in) :: part            !< number of the independent mechanism
      integer, intent(in) :: links(:)        !< (any number) of the links in the part
      character(label_length), allocatable :: names(:)

      associate (own => set%parts(part))
         names = own%links(shown_links(own, links))%name
      end associate
   end function link_names

   !> Names the measure of a diagnostic or, if it has none, its pair. The diagnostic must have one of these.
   pure function name_in(set, diagnostic) result(name)
      class(set_t), intent(in) :: set        !< a divided set
      type(diagnostic_t), intent(in) :: diagnostic   !< about a pair or a measure
      character(label_length) :: name

      associate (own => set%parts(diagnostic%part))
         if (diagnostic%pair > 0) name = own%pairs(diagnostic%pair)%name
         if (diagnostic%measure > 0) name = own%measures(diagnostic%measure)%name
      end associate
   end function name_in

   !> Tells whether a set has cylinders.
   pure logical function has_cylinders(set)
      class(set_t), intent(in) :: set        !< a divided set
      integer :: c

      has_cylinders = any([(any(set%parts(c)%pairs%is_cylinder), c=1, set%count)])
   end function has_cylinders

   !> Gives a drive of a set with its law. Assign the result: in an expression gfortran does not free its memory.
   pure type(drive_t) function drive_of(set, i)
      class(set_t), intent(in) :: set        !< a divided set
      integer, intent(in) :: i               !< number of the drive in the set

      drive_of = set%parts(set%drives(i)%part)%drives(set%drives(i)%number)
   end function drive_of

   !> Finds the number of a drive of a part among the drives of the set; 0: the part has no such drive.
   pure integer function drive_number(set, part, number)
      class(set_t), intent(in) :: set        !< a divided set
      integer, intent(in) :: part            !< number of the independent mechanism
      integer, intent(in) :: number          !< number of the drive in the part

      drive_number = findloc(set%drives%part == part .and. set%drives%number == number, .true., dim=1)
   end function drive_number

   !> Names a drive of a set: kind, and names of its links, point or pair.
   pure function drive_title(set, i) result(name)
      class(set_t), intent(in) :: set        !< a divided set
      integer, intent(in) :: i               !< number of the drive in the set
      character(:), allocatable :: name

      name = name_of_drive(set, set%drives(i)%part, set%drives(i)%number)
   end function drive_title

   !> Names a drive of a part: kind, and names of its links, point or pair.
   pure function name_of_drive(set, part, number) result(name)
      class(set_t), intent(in) :: set        !< a divided set
      integer, intent(in) :: part            !< number of the independent mechanism
      integer, intent(in) :: number          !< number of the drive in the part
      character(:), allocatable :: name

      name = trim(drive_name(set%parts(part), set%parts(part)%drives(number)))
   end function name_of_drive

   !> Counts the drives before a drive, in its independent mechanism, that drive its coordinate as well.
   pure integer function same_before(set, i) result(count_before)
      class(set_t), intent(in) :: set        !< a divided set
      integer, intent(in) :: i               !< number of the drive in the set

      associate (n => set%drives(i)%number, drives => set%parts(set%drives(i)%part)%drives)
         count_before = count(drives(:n - 1)%kind == drives(n)%kind .and. drives(:n - 1)%subject == drives(n)%subject &
            .and. drives(:n - 1)%second == drives(n)%second)
      end associate
   end function same_before
end module set_members
