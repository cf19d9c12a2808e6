!> The independent mechanisms (parts) of a set: links that pairs or drives join, but not through the ground. No part
!> acts on another: each is solved as a mechanism with numbering and characteristic lengths of its own. The set keeps
!> its settings, and for each row and drive, in the order of the cards, its part and its number there.
module independent
   use disjoint_sets, only: sorted, sorted_numbers, sorted_t, members, once, joined
   use kinds, only: wp
   use mechanism, only: settings_t, mechanism_t, request_t, subject_t, pair_links, drive_links, request_links, &
      subject_links, measure_links, measures_within, measure_count, drive_relangle, driven_kinds, request_link, &
      request_point, request_pair, request_measure, parameter_link, parameter_knot, &
      parameter_length, parameter_joint, parameter_hole
   use columns, only: kinds_of_rows
   use scales, only: characteristic_length, characteristic_rate
   implicit none
   private
   public :: set_t, divide, part_of_links, request_of, first_drive

   !> A row or drive of a set: the number of its part, and its number there.
   type :: member_t
      integer :: part = 1, number = 0        !< of the part in the set; of the row or drive in the part
   end type member_t

   !> A numbering of the members of one kind, in one of two directions:
   !>
   !> - `of` (members of the part) has their numbers in the set, increasing; the index is the number in the part;
   !> - `of` (0:members of the set) has their numbers in the part; 0: not in the part.
   type :: numbering_t
      integer, allocatable :: of(:)
   end type numbering_t

   !> The kind of drives, after links, points, pairs and measures (request_link, ..., request_measure).
   integer, parameter :: of_drives = 5
   !> The kinds of the subjects of numbers on cards, for each kind of number.
   integer, parameter :: of_numbers(parameter_link:parameter_knot) = &
      [request_link, request_point, request_point, request_pair, of_drives, of_drives]

   !> A set, divided into parts. A row of a ground point belongs to a part whose pairs use the point; all other rows of
   !> only the ground belong to the first part.
   type, extends(settings_t) :: set_t
      integer :: count = 1                          !< number of independent mechanisms
      type(mechanism_t), allocatable :: parts(:)    !< (count)
      type(member_t), allocatable :: rows(:), drives(:)   !< (rows, drives) in the order of the cards
      type(numbering_t), allocatable :: cards(:)    !< (count) numbers of the links in the set, for pictures
      real(wp) :: largest_tolerance = 0.0_wp        !< in characteristic lengths and rates, at most 1; 0: none
   end type set_t

contains

   !> Divides a set into its parts. A part has the ground links, and their points, that its pairs, drives and rows use.
   !> A BRANCH card without a link belongs to every part. Time and memory grow in proportion to the deck.
   subroutine divide(m, set)
      type(mechanism_t), intent(in) :: m
      type(set_t), intent(out) :: set        !< the set, divided
      type(sorted_t) :: links, points, pairs, measures, drives, rows
      type(numbering_t) :: new_number(of_drives), part(of_drives)
      integer, allocatable :: pair_part(:), drive_part(:), row_part(:), user(:), used(:), own_rows(:), branches(:), &
         measuring(:)
      type(subject_t), allocatable :: measured(:)   ! all measures and their subjects, with the part `measuring` of each
      integer :: link_part(size(m%links)), point_part(size(m%points)), i, k
      real(wp) :: length, rate

      set%settings_t = m%settings_t
      if (allocated(m%tolerances)) then
         length = characteristic_length(m)
         rate = characteristic_rate(m, length)
         set%largest_tolerance = min(1.0_wp, max(epsilon(1.0_wp), maxval(m%tolerances%size_of*m%tolerances%unit &
            *rate**m%tolerances%powers(2)/length**m%tolerances%powers(1))))
      end if

      link_part = part_of_links(m)
      set%count = maxval([1, link_part])
      if (set%count == 1) then
         call make_single_part(m, set)
         return
      end if
      pair_part = [(part_of(link_part, pair_links(m, m%pairs(i))), i=1, size(m%pairs))]
      drive_part = [(part_of(link_part, drive_links(m, m%drives(i))), i=1, size(m%drives))]
      row_part = [(part_of(link_part, request_links(m, m%requests(i))), i=1, size(m%requests))]
      point_part = 0
      do i = 1, size(m%pairs)
         point_part([m%pairs(i)%point_i, m%pairs(i)%point_j]) = pair_part(i)
      end do
      do i = 1, size(m%requests)
         if (m%requests(i)%kind == request_point) row_part(i) = max(row_part(i), point_part(m%requests(i)%subject))
      end do

      pairs = sorted(pair_part, set%count)
      drives = sorted(drive_part, set%count)
      rows = sorted(row_part, set%count)
      call find_measured(m, link_part, measured, measuring)
      measures = sorted_numbers(pack(measured%number, measured%kind == request_measure), &
         pack(measuring, measured%kind == request_measure), set%count)

      ! Each point, and each link, once for its own part and once for each use by a part.
      associate (of_points => pack([(i, i=1, size(m%requests))], &
                                   kinds_of_rows(m%requests%kind)%subject == request_point), &
                 is_point => measured%kind == request_point)
         used = [(i, i=1, size(m%points)), m%pairs%point_i, m%pairs%point_j, pack(measured%number, is_point), &
            m%requests(of_points)%subject]
         user = [link_part(m%points%link), pair_part, pair_part, pack(measuring, is_point), row_part(of_points)]
      end associate
      call add_lengths()
      points = sorted_numbers(used, user, set%count)
      associate (is_link => measured%kind == request_link, &
                 others => pack([(i, i=1, size(m%requests))], m%requests%kind /= request_measure))
         used = [(i, i=1, size(m%links)), m%points(used)%link, (drive_links(m, m%drives(i)), i=1, size(m%drives)), &
            pack(measured%number, is_link), (subject_links(m, m%requests(others(i))%kind, &
            m%requests(others(i))%subject, m%requests(others(i))%second), i=1, size(others))]
         user = [link_part, user, (spread(drive_part(i), 1, 3), i=1, size(m%drives)), pack(measuring, is_link), &
            (spread(row_part(others(i)), 1, 3), i=1, size(others))]
      end associate
      links = sorted_numbers(used, user, set%count)

      allocate (set%parts(set%count), set%cards(set%count), set%rows(size(m%requests)), set%drives(size(m%drives)))
      associate (n => [size(m%links), size(m%points), size(m%pairs), maxval([0, pack(measured%number, &
                       measured%kind == request_measure)]), size(m%drives)])
         do k = 1, of_drives
            allocate (new_number(k)%of(0:n(k)), source=0)
         end do
      end associate

      do k = 1, set%count
         part(request_link)%of = once(members(links, k))
         part(request_point)%of = once(members(points, k))
         part(request_pair)%of = members(pairs, k)
         part(request_measure)%of = once(members(measures, k))
         part(of_drives)%of = members(drives, k)
         own_rows = members(rows, k)
         branches = [integer ::]
         if (allocated(m%branch_requests)) branches = pack([(i, i=1, size(m%branch_requests))], &
            [(m%branch_requests(i)%link == 0 .or. link_part(max(1, m%branch_requests(i)%link)) == k, &
            i=1, size(m%branch_requests))])
         set%rows(own_rows) = [(member_t(k, i), i=1, size(own_rows))]
         set%drives(part(of_drives)%of) = [(member_t(k, i), i=1, size(part(of_drives)%of))]
         call separate_mechanism(m, part, own_rows, branches, new_number, set%parts(k))
         call move_alloc(part(request_link)%of, set%cards(k)%of)
      end do

   contains

      !> Adds the ground points of all lengths to every part, if numbers have tolerances: one length moves the points of
      !> others.
      subroutine add_lengths()
         integer :: i, k

         if (.not. (allocated(m%lengths) .and. allocated(m%tolerances))) return
         do i = 1, size(m%lengths)
            if (.not. m%links(m%points(m%lengths(i)%point(1))%link)%ground) cycle
            used = [used, (m%lengths(i)%point, k=1, set%count)]
            user = [user, (k, k, k=1, set%count)]
         end do
      end subroutine add_lengths
   end subroutine divide

   !> Makes a divided set of one part: the whole mechanism, without its texts.
   subroutine make_single_part(m, set)
      type(mechanism_t), intent(in) :: m
      type(set_t), intent(inout) :: set      !< has its settings and its count, 1
      integer :: i

      set%rows = [(member_t(1, i), i=1, size(m%requests))]
      set%drives = [(member_t(1, i), i=1, size(m%drives))]
      allocate (set%parts(1), set%cards(1))
      set%cards(1)%of = [(i, i=1, size(m%links))]
      set%parts(1) = m
      ! A part is copied for each change of a number: its texts would only take time.
      if (allocated(m%echo)) deallocate (set%parts(1)%echo)
      if (allocated(m%remarks)) deallocate (set%parts(1)%remarks)
      if (allocated(m%branch_requests)) set%parts(1)%branch_requests%card = [(i, i=1, size(m%branch_requests))]
      call set_characteristic_sizes(set%parts(1))
   end subroutine make_single_part

   !> Computes the characteristic sizes of a part that its rows need: the length for measures; length and rate for poles
   !> and curves.
   subroutine set_characteristic_sizes(own)
      type(mechanism_t), intent(inout) :: own   !< the part, with its requests and measures

      if (allocated(own%measures)) own%measures%length = characteristic_length(own)
      if (any(kinds_of_rows(own%requests%kind)%is_centre)) then
         own%requests%length = characteristic_length(own)
         own%requests%rate = characteristic_rate(own, own%requests(1)%length)
      end if
   end subroutine set_characteristic_sizes

   !> Lists each measure, the measures within this measure, and all their subjects, each with the part of the links of
   !> the measure. Subjects on the ground are listed for several parts.
   subroutine find_measured(m, link_part, measured, measuring)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: link_part(:)    !< (links) the part of each; 0: ground
      type(subject_t), allocatable, intent(out) :: measured(:)   !< (entries) measures and subjects, some several times
      integer, allocatable, intent(out) :: measuring(:)   !< (entries) the part of each
      integer, allocatable :: list(:)
      integer :: last, n, j, pass

      do pass = 1, 2
         last = 0
         do n = 1, measure_count(m)
            list = measures_within(m, n)
            do j = 1, size(list)
               associate (subjects => m%measures(list(j))%subjects, first => last + 1)
                  last = last + 1 + size(subjects)
                  if (pass == 1) cycle
                  measured(first:last) = [subject_t(request_measure, list(j)), subjects]
                  measuring(first:last) = part_of(link_part, measure_links(m, m%measures(n)))
               end associate
            end do
         end do
         if (pass == 1) allocate (measured(last), measuring(last))
      end do
   end subroutine find_measured

   !> Finds the part to which a pair, drive, row or measure belongs, from its links. With only ground links the part is
   !> 1.
   pure integer function part_of(link_part, links)
      integer, intent(in) :: link_part(:) !< (links of the set) the part of each; 0: ground
      integer, intent(in) :: links(:)     !< (any number) numbers of the links

      part_of = maxval([1, link_part(links)])
   end function part_of

   !> Finds the part of each link (links): parts are numbered in the order of their first links in the deck. A ground
   !> link has the part 0.
   pure function part_of_links(m) result(part)
      type(mechanism_t), intent(in) :: m
      integer :: part(size(m%links))

      associate (relative => m%drives%kind == drive_relangle)
         part = joined(.not. m%links%ground, &
            [m%points(m%pairs%point_i)%link, pack(m%drives%subject, relative)], &
            [m%points(m%pairs%point_j)%link, pack(m%drives%second, relative)])
      end associate
   end function part_of_links

   !> Makes a mechanism of a part of a set, in the part's own numbers.
   subroutine separate_mechanism(m, part, rows, branches, new_number, own)
      type(mechanism_t), intent(in) :: m     !< the set
      type(numbering_t), intent(in) :: part(:)   !< (of_drives) for each kind, members' numbers in the set
      integer, intent(in) :: rows(:)         !< (rows of the part) numbers of its requests in the set
      integer, intent(in) :: branches(:)     !< (BRANCH cards of the part) their numbers in the set
      !> (of_drives) for each kind, scratch (0:members of the set): zeros before and after. Reason: each of many parts
      !> then takes only the time of its own size.
      type(numbering_t), intent(inout) :: new_number(:)
      type(mechanism_t), intent(out) :: own  !< the part
      logical, allocatable :: kept(:)        ! (lengths) the length belongs to the part
      integer :: i, k, kind

      do kind = 1, size(part)
         new_number(kind)%of(part(kind)%of) = [(i, i=1, size(part(kind)%of))]
      end do
      own%settings_t = m%settings_t
      own%links = m%links(part(request_link)%of)
      own%points = m%points(part(request_point)%of)
      own%points%link = new_number(request_link)%of(own%points%link)
      own%pairs = m%pairs(part(request_pair)%of)
      own%pairs%point_i = new_number(request_point)%of(own%pairs%point_i)
      own%pairs%point_j = new_number(request_point)%of(own%pairs%point_j)
      own%pairs%pin = new_number(request_point)%of(own%pairs%pin)

      if (allocated(m%measures)) then
         own%measures = m%measures(part(request_measure)%of)
         do i = 1, size(own%measures)
            do k = 1, size(own%measures(i)%subjects)
               associate (one => own%measures(i)%subjects(k))
                  one%number = new_number(one%kind)%of(one%number)
               end associate
            end do
         end do
      end if

      own%drives = m%drives(part(of_drives)%of)
      own%drives%second = new_number(request_link)%of(own%drives%second)
      do i = 1, size(own%drives)
         own%drives(i)%subject = new_number(driven_kinds(own%drives(i)%kind))%of(own%drives(i)%subject)
      end do
      own%requests = m%requests(rows)
      own%requests%second = new_number(request_link)%of(own%requests%second)
      own%requests%drive = new_number(of_drives)%of(own%requests%drive)
      do i = 1, size(own%requests)
         own%requests(i)%subject = new_number(kinds_of_rows(own%requests(i)%kind)%subject)%of(own%requests(i)%subject)
      end do

      if (allocated(m%branch_requests)) then
         own%branch_requests = m%branch_requests(branches)
         own%branch_requests%card = branches
         own%branch_requests%link = new_number(request_link)%of(own%branch_requests%link)
      end if

      if (allocated(m%lengths)) then
         associate (of => new_number(request_point)%of)
            kept = of(m%lengths%point(1)) > 0 .and. of(m%lengths%point(2)) > 0
            own%lengths = pack(m%lengths, kept)
            own%lengths%point(1) = of(own%lengths%point(1))
            own%lengths%point(2) = of(own%lengths%point(2))
         end associate
      end if
      own%links%from = new_number(request_point)%of(own%links%from)
      own%links%to = new_number(request_point)%of(own%links%to)

      if (allocated(m%tolerances)) then
         own%tolerances = m%tolerances
         do i = 1, size(own%tolerances)
            associate (one => own%tolerances(i))
               if (one%kind == parameter_length) then
                  one%subject = merge(count(kept(:one%subject)), 0, kept(one%subject))
               else if (one%kind == parameter_hole) then
                  one%subject = findloc(own%points%hole, m%points(one%subject)%hole, dim=1)
               else
                  ! A part may have one point of a joint alone, that on the ground.
                  if (one%kind == parameter_joint .and. new_number(request_point)%of(one%subject) == 0) &
                     one%subject = one%subject + 1
                  one%subject = new_number(of_numbers(one%kind))%of(one%subject)
               end if
            end associate
         end do
         own%tolerances = pack(own%tolerances, own%tolerances%subject > 0)
      end if

      call set_characteristic_sizes(own)
      do kind = 1, size(part)
         new_number(kind)%of(part(kind)%of) = 0
      end do
   end subroutine separate_mechanism

   !> Gives the request of a row of a divided set, in the numbers of the row's part.
   pure type(request_t) function request_of(set, i)
      class(set_t), intent(in) :: set        !< a divided set
      integer, intent(in) :: i               !< number of the row among the rows of the set

      request_of = set%parts(set%rows(i)%part)%requests(set%rows(i)%number)
   end function request_of

   !> Finds the first drive of the independent mechanism of a row: the drive's number among all drives of the set; 0 if
   !> the mechanism has no drive.
   pure integer function first_drive(set, i)
      class(set_t), intent(in) :: set        !< a divided set
      integer, intent(in) :: i               !< number of the row among the rows of the set

      first_drive = findloc(set%drives%part, set%rows(i)%part, dim=1)
   end function first_drive
end module independent
