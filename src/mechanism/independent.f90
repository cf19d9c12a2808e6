!> The independent mechanisms of a set: links that pairs or drives join, but not through the ground. None of them acts
!> on another: each is solved as a set of its own, in its own numbers and its own lengths.
module independent
   use grouping, only: sorted_t, sorted, sorted_numbers, members, once, joined
   use mechanism, only: mechanism_t, tolerance_t, pair_links, drive_links, request_links, drive_relangle, &
      driven_kinds, request_link, request_point, request_pair, request_pole, request_curve, number_ground, number_pair
   use scales, only: characteristic_length, characteristic_rate
   implicit none
   private
   public :: part_t, parts_t, find_parts, part_of_links, mechanism_of

   !> The members of a part by their numbers in the whole set, increasing; the place in the list is the number within
   !> the part. A BRANCH card without a link is for every part.
   type :: part_t
      !> Their numbers in the set.
      integer, allocatable :: links(:), points(:), pairs(:), drives(:), requests(:), branch_requests(:)
   end type part_t

   !> The parts of a set. A set that is one mechanism has `count` 1, and nothing else is allocated.
   type :: parts_t
      integer :: count = 1                        !< of independent mechanisms, the ground apart
      type(part_t), allocatable :: list(:)        !< (count)
      integer, allocatable :: part(:), number(:)  !< (requests) the part, 0: the ground's; the number within the part
   end type parts_t

contains

   !> Finds the parts `p` of the set `m`, and makes each a set of its own: `own` (parts), of size 0 where there is one
   !> part. A part has the ground links, and their points, that its pairs, drives and requests use. Time and memory grow
   !> in proportion to the deck.
   subroutine find_parts(m, p, own)
      type(mechanism_t), intent(in) :: m
      type(parts_t), intent(out) :: p
      type(mechanism_t), allocatable, intent(out) :: own(:)
      integer :: link_part(size(m%links)), i, c
      integer, allocatable :: pair_part(:), drive_part(:), user(:), used(:)
      type(sorted_t) :: links, points, pairs, drives, requests

      link_part = part_of_links(m)
      p%count = max(1, maxval([0, link_part]))
      if (p%count == 1) then
         allocate (own(0))
         return
      end if
      allocate (own(p%count), p%list(p%count))
      pair_part = [(maxval(link_part(pair_links(m, m%pairs(i)))), i=1, size(m%pairs))]
      drive_part = [(maxval(link_part(drive_links(m, m%drives(i)))), i=1, size(m%drives))]
      p%part = [(maxval(link_part(request_links(m, m%requests(i)))), i=1, size(m%requests))]
      pairs = sorted(pair_part, p%count)
      drives = sorted(drive_part, p%count)
      requests = sorted(p%part, p%count)
      ! Each point, and each link, with the part that it belongs to or that uses it.
      associate (curves => pack([(i, i=1, size(m%requests))], m%requests%kind == request_curve))
         used = [(i, i=1, size(m%points)), m%pairs%point_i, m%pairs%point_j, m%requests(curves)%subject]
         user = [link_part(m%points%link), pair_part, pair_part, p%part(curves)]
      end associate
      points = sorted_numbers(used, user, p%count)
      used = [(i, i=1, size(m%links)), m%points(used)%link, (drive_links(m, m%drives(i)), i=1, size(m%drives)), &
         (request_links(m, m%requests(i)), i=1, size(m%requests))]
      user = [link_part, user, (spread(drive_part(i), 1, 3), i=1, size(m%drives)), &
         (spread(p%part(i), 1, 3), i=1, size(m%requests))]
      links = sorted_numbers(used, user, p%count)
      allocate (p%number(size(m%requests)), source=0)
      do c = 1, p%count
         associate (part => p%list(c))
            part%links = once(members(links, c))
            part%points = once(members(points, c))
            part%pairs = members(pairs, c)
            part%drives = members(drives, c)
            part%requests = members(requests, c)
            p%number(part%requests) = [(i, i=1, size(part%requests))]
            part%branch_requests = branch_requests_of(m, link_part, c)
         end associate
         own(c) = mechanism_of(m, p%list(c))
      end do
   end subroutine find_parts

   !> (links) The number of the part of each link, in the order of the deck; 0 of a ground link.
   pure function part_of_links(m) result(part)
      type(mechanism_t), intent(in) :: m
      integer :: part(size(m%links))

      associate (relative => m%drives%kind == drive_relangle)
         part = joined(.not. m%links%ground, &
            [m%points(m%pairs%point_i)%link, pack(m%drives%subject, relative)], &
            [m%points(m%pairs%point_j)%link, pack(m%drives%second, relative)])
      end associate
   end function part_of_links

   !> The BRANCH cards of part `c`.
   pure function branch_requests_of(m, link_part, c) result(list)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: link_part(:), c
      integer, allocatable :: list(:)
      integer :: i

      allocate (list(0))
      if (.not. allocated(m%branch_requests)) return
      do i = 1, size(m%branch_requests)
         if (m%branch_requests(i)%link > 0) then
            if (link_part(m%branch_requests(i)%link) /= c) cycle
         end if
         list = [list, i]
      end do
   end function branch_requests_of

   !> The `part` of `m` as a set of its own, without its cards.
   function mechanism_of(m, part) result(own)
      type(mechanism_t), intent(in) :: m
      type(part_t), intent(in) :: part
      type(mechanism_t) :: own
      integer :: i

      own%settings_t = m%settings_t
      own%links = m%links(part%links)
      own%points = m%points(part%points)
      own%pairs = m%pairs(part%pairs)
      own%drives = m%drives(part%drives)
      own%requests = m%requests(part%requests)
      allocate (own%branch_requests(size(part%branch_requests)))
      do i = 1, size(part%branch_requests)
         associate (request => own%branch_requests(i))
            request = m%branch_requests(part%branch_requests(i))
            if (request%link > 0) request%link = place_in(part%links, request%link)
         end associate
      end do
      own%points%link = [(place_in(part%links, own%points(i)%link), i=1, size(own%points))]
      own%pairs%point_i = [(place_in(part%points, own%pairs(i)%point_i), i=1, size(own%pairs))]
      own%pairs%point_j = [(place_in(part%points, own%pairs(i)%point_j), i=1, size(own%pairs))]
      do i = 1, size(own%drives)
         associate (d => own%drives(i))
            d%subject = number_in(part, driven_kinds(d%kind), d%subject)
            if (d%kind == drive_relangle) d%second = place_in(part%links, d%second)
         end associate
      end do
      do i = 1, size(own%requests)
         own%requests(i)%subject = number_in(part, own%requests(i)%kind, own%requests(i)%subject)
         if (own%requests(i)%second > 0) own%requests(i)%second = place_in(part%links, own%requests(i)%second)
      end do
      if (allocated(m%tolerances)) own%tolerances = tolerances_of(m%tolerances, part)
      if (.not. any(own%requests%kind >= request_pole)) return
      own%requests%length = characteristic_length(own)
      own%requests%rate = characteristic_rate(own, own%requests(1)%length)
   end function mechanism_of

   !> Those of `list` whose numbers are in `part`, in the numbers of the part.
   pure function tolerances_of(list, part) result(own)
      type(tolerance_t), intent(in) :: list(:)
      type(part_t), intent(in) :: part
      type(tolerance_t), allocatable :: own(:)
      integer, parameter :: kinds(number_ground:number_pair) = [request_link, request_point, request_point, &
         request_pair]
      integer :: i

      own = list
      do i = 1, size(own)
         associate (k => list(i)%kind, n => list(i)%subject)
            if (k > number_pair) own(i)%subject = place_in(part%drives, n)
            if (k <= number_pair) own(i)%subject = number_in(part, kinds(k), n)
         end associate
      end do
      own = pack(own, own%subject > 0)
   end function tolerances_of

   !> The number within `part` of the link, point or pair (`kind`: request_link, ...) number `i` of the whole set.
   pure integer function number_in(part, kind, i)
      type(part_t), intent(in) :: part
      integer, intent(in) :: kind, i

      select case (kind)
      case (request_link, request_pole)
         number_in = place_in(part%links, i)
      case (request_point, request_curve)
         number_in = place_in(part%points, i)
      case default
         number_in = place_in(part%pairs, i)
      end select
   end function number_in

   !> The place of `x` in the increasing `list`, by bisection; 0: it is not there.
   pure integer function place_in(list, x) result(low)
      integer, intent(in) :: list(:), x
      integer :: high, middle

      low = 1
      high = size(list)
      do while (low < high)
         middle = (low + high)/2
         if (list(middle) < x) then
            low = middle + 1
         else
            high = middle
         end if
      end do
      if (all(list(low:high) /= x)) low = 0
   end function place_in
end module independent
