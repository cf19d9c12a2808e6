!> The independent mechanisms of a set: links that pairs or drives join, but not through the ground. None of them acts
!> on another: each is solved as a set of its own, in its own numbers and its own lengths.
module independent
   use mechanism, only: mechanism_t, request_t, tolerance_t, drive_relangle, driven_kinds, request_link, &
      request_point, request_pair, request_pole, request_curve, number_ground, number_pair
   use scales, only: characteristic_length, characteristic_rate
   implicit none
   private
   public :: sorted_t, sorted, part_t, parts_t, find_parts, part_of_links, part_of_pair, part_of_drive, mechanism_of

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

   !> Numbers sorted by part: those of part k are member(first(k)), ..., member(first(k + 1) - 1), increasing.
   type :: sorted_t
      integer, allocatable :: first(:), member(:)
   end type sorted_t

contains

   !> Finds the parts `p` of the set `m`, and makes each a set of its own: `own` (parts), of size 0 where there is one
   !> part. A part has the ground links, and their points, that its pairs, drives and requests use. Time and memory grow
   !> in proportion to the deck.
   subroutine find_parts(m, p, own)
      type(mechanism_t), intent(in) :: m
      type(parts_t), intent(out) :: p
      type(mechanism_t), allocatable, intent(out) :: own(:)
      integer :: link_part(size(m%links)), i, c
      type(sorted_t) :: links, points, pairs, drives, requests
      logical :: seen(size(m%links) + size(m%points))

      link_part = part_of_links(m)
      p%count = max(1, maxval([0, link_part]))
      if (p%count == 1) then
         allocate (own(0))
         return
      end if
      allocate (own(p%count), p%list(p%count))
      p%part = [(part_of_request(m, link_part, m%requests(i)), i=1, size(m%requests))]
      links = sorted(link_part, p%count)
      points = sorted(link_part(m%points%link), p%count)
      pairs = sorted([(part_of_pair(m, link_part, i), i=1, size(m%pairs))], p%count)
      drives = sorted([(part_of_drive(m, link_part, i), i=1, size(m%drives))], p%count)
      requests = sorted(p%part, p%count)
      allocate (p%number(size(m%requests)), source=0)
      seen = .false.
      do c = 1, p%count
         associate (part => p%list(c))
            part%links = members(links, c)
            part%points = members(points, c)
            part%pairs = members(pairs, c)
            part%drives = members(drives, c)
            part%requests = members(requests, c)
            p%number(part%requests) = [(i, i=1, size(part%requests))]
            part%branch_requests = branch_requests_of(m, link_part, c)
            call add_ground(m, seen, part)
         end associate
         own(c) = mechanism_of(m, p%list(c))
      end do
   end subroutine find_parts

   !> (links) The number of the part of each link, in the order of the deck; 0 of a ground link.
   function part_of_links(m) result(part)
      type(mechanism_t), intent(in) :: m
      integer :: part(size(m%links))
      integer :: parent(size(m%links)), i, count

      parent = [(i, i=1, size(m%links))]
      do i = 1, size(m%pairs)
         call join(m, parent, m%points(m%pairs(i)%point_i)%link, m%points(m%pairs(i)%point_j)%link)
      end do
      do i = 1, size(m%drives)
         if (m%drives(i)%kind == drive_relangle) call join(m, parent, m%drives(i)%subject, m%drives(i)%second)
      end do
      part = 0
      count = 0
      do i = 1, size(m%links)
         if (m%links(i)%ground) cycle
         if (parent(i) == i) then
            count = count + 1
            part(i) = count
         else
            ! The parent has the smaller number: its part is known.
            part(i) = part(parent(i))
         end if
      end do
   end function part_of_links

   !> Puts the links `i` and `j` into one part, unless one is the ground. `parent` (links): the trees of the parts so
   !> far.
   subroutine join(m, parent, i, j)
      type(mechanism_t), intent(in) :: m
      integer, intent(inout) :: parent(:)
      integer, intent(in) :: i, j
      integer :: a, b

      if (m%links(i)%ground .or. m%links(j)%ground) return
      call find_root(parent, i, a)
      call find_root(parent, j, b)
      parent(max(a, b)) = min(a, b)
   end subroutine join

   !> The `root` of the tree of link `i`. The path to it is halved.
   pure subroutine find_root(parent, i, root)
      integer, intent(inout) :: parent(:)
      integer, intent(in) :: i
      integer, intent(out) :: root

      root = i
      do while (parent(root) /= root)
         parent(root) = parent(parent(root))
         root = parent(root)
      end do
   end subroutine find_root

   !> The part of the link, point or pair (`kind`: request_link, ...) number `i`; 0: the ground's.
   pure integer function part_of(m, link_part, kind, i) result(part)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: link_part(:), kind, i

      select case (kind)
      case (request_link, request_pole)
         part = link_part(i)
      case (request_point, request_curve)
         part = link_part(m%points(i)%link)
      case default
         part = part_of_pair(m, link_part, i)
      end select
   end function part_of

   !> The part of `request`; 0: the ground's.
   pure integer function part_of_request(m, link_part, request) result(part)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: link_part(:)
      type(request_t), intent(in) :: request

      part = part_of(m, link_part, request%kind, request%subject)
      if (request%second > 0) part = max(part, link_part(request%second))
   end function part_of_request

   !> The part of pair number `i`.
   pure integer function part_of_pair(m, link_part, i) result(part)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: link_part(:), i

      part = max(link_part(m%points(m%pairs(i)%point_i)%link), link_part(m%points(m%pairs(i)%point_j)%link))
   end function part_of_pair

   !> The part of drive number `i`.
   pure integer function part_of_drive(m, link_part, i) result(part)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: link_part(:), i

      associate (d => m%drives(i))
         part = part_of(m, link_part, driven_kinds(d%kind), d%subject)
         if (d%kind == drive_relangle) part = max(part, link_part(d%second))
      end associate
   end function part_of_drive

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

   !> Adds to `part` the ground links, and their points, that its pairs, drives and requests use. `seen` (links, then
   !> points): all false before and after.
   subroutine add_ground(m, seen, part)
      type(mechanism_t), intent(in) :: m
      logical, intent(inout) :: seen(:)
      type(part_t), intent(inout) :: part
      integer, allocatable :: links(:), points(:)
      integer :: i

      allocate (links(0), points(0))
      do i = 1, size(part%pairs)
         call add_point(m%pairs(part%pairs(i))%point_i)
         call add_point(m%pairs(part%pairs(i))%point_j)
      end do
      do i = 1, size(part%drives)
         associate (d => m%drives(part%drives(i)))
            if (d%kind == drive_relangle) call add_link(d%subject)
            if (d%kind == drive_relangle) call add_link(d%second)
         end associate
      end do
      do i = 1, size(part%requests)
         associate (request => m%requests(part%requests(i)))
            if (request%kind == request_pole) call add_link(request%subject)
            if (request%kind == request_curve) call add_point(request%subject)
            if (request%second > 0) call add_link(request%second)
         end associate
      end do
      seen(links) = .false.
      seen(size(m%links) + points) = .false.
      part%links = merged(part%links, links)
      part%points = merged(part%points, points)

   contains

      !> Adds point `k` and its link, if they belong to the ground.
      subroutine add_point(k)
         integer, intent(in) :: k

         if (.not. m%links(m%points(k)%link)%ground) return
         call add_link(m%points(k)%link)
         if (.not. seen(size(m%links) + k)) points = [points, k]
         seen(size(m%links) + k) = .true.
      end subroutine add_point

      !> Adds link `k`, if it is ground.
      subroutine add_link(k)
         integer, intent(in) :: k

         if (.not. m%links(k)%ground) return
         if (.not. seen(k)) links = [links, k]
         seen(k) = .true.
      end subroutine add_link
   end subroutine add_ground

   !> The numbers 1, 2, ... of what has the parts `part`, sorted by part; those of part 0 are left out.
   pure function sorted(part, parts) result(s)
      integer, intent(in) :: part(:), parts
      type(sorted_t) :: s
      integer :: next(0:parts), i

      allocate (s%first(parts + 1), s%member(count(part > 0)))
      s%first = 0
      do i = 1, size(part)
         if (part(i) > 0) s%first(part(i) + 1) = s%first(part(i) + 1) + 1
      end do
      s%first(1) = 1
      do i = 1, parts
         s%first(i + 1) = s%first(i) + s%first(i + 1)
      end do
      next(1:) = s%first(:parts)
      do i = 1, size(part)
         if (part(i) == 0) cycle
         s%member(next(part(i))) = i
         next(part(i)) = next(part(i)) + 1
      end do
   end function sorted

   !> The numbers of part `c`.
   pure function members(s, c) result(list)
      type(sorted_t), intent(in) :: s
      integer, intent(in) :: c
      integer, allocatable :: list(:)

      list = s%member(s%first(c):s%first(c + 1) - 1)
   end function members

   !> The increasing list `a` and the few numbers `b`, in one increasing list.
   pure function merged(a, b) result(list)
      integer, intent(in) :: a(:), b(:)
      integer, allocatable :: list(:)
      integer :: rest(size(b)), i, k, n
      logical :: from_a

      rest = b
      do i = 2, size(b)
         n = rest(i)
         do k = i - 1, 1, -1
            if (rest(k) < n) exit
            rest(k + 1) = rest(k)
         end do
         rest(k + 1) = n
      end do
      allocate (list(size(a) + size(b)))
      i = 1
      k = 1
      do n = 1, size(list)
         from_a = i <= size(a)
         if (from_a .and. k <= size(b)) from_a = a(i) < rest(k)
         if (from_a) then
            list(n) = a(i)
            i = i + 1
         else
            list(n) = rest(k)
            k = k + 1
         end if
      end do
   end function merged

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
