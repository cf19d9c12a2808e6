!> The independent mechanisms of a set: links that neither pairs nor drives join, but through the ground. What
!> one of them does has nothing to do with the others: each is solved as if it were alone, in its own lengths.
module independent
   use mechanism, only: mechanism_t, drive_angle, drive_x, drive_y, drive_relangle, request_link, request_point
   use part_mechanism, only: part_t, mechanism_of
   implicit none
   private
   public :: parts_t, find_parts, part_of_links

   !> A set that is one mechanism has `count` 1, and nothing else is allocated.
   type :: parts_t
      integer :: count = 1
      type(part_t), allocatable :: list(:)
      integer, allocatable :: part(:), number(:)  !< (requests) the part, 0: the ground's; the number in its requests
   end type parts_t

   !> Members by part: those of part k are member(first(k)), ..., member(first(k + 1) - 1), in the deck's order.
   type :: sorted_t
      integer, allocatable :: first(:), member(:)
   end type sorted_t

contains

   !> The parts of the set `m`, and each as a set of its own: `own` (parts), of size 0 where there is one part. A part
   !> has the ground links and their points that its pairs and drives touch. Time and memory in proportion to the deck.
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
      p%part = [(part_of_request(m, link_part, i), i=1, size(m%requests))]
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
      integer :: above(size(m%links)), i, count

      above = [(i, i=1, size(m%links))]
      do i = 1, size(m%pairs)
         call join(m, above, m%points(m%pairs(i)%point_i)%link, m%points(m%pairs(i)%point_j)%link)
      end do
      do i = 1, size(m%drives)
         if (m%drives(i)%kind == drive_relangle) call join(m, above, m%drives(i)%subject, m%drives(i)%second)
      end do
      part = 0
      count = 0
      do i = 1, size(m%links)
         if (m%links(i)%ground) cycle
         if (above(i) == i) then
            count = count + 1
            part(i) = count
         else
            ! What is above comes before.
            part(i) = part(above(i))
         end if
      end do
   end function part_of_links

   !> Links `i` and `j` are in one part, unless one is the ground.
   subroutine join(m, above, i, j)
      type(mechanism_t), intent(in) :: m
      integer, intent(inout) :: above(:)
      integer, intent(in) :: i, j
      integer :: a, b

      if (m%links(i)%ground .or. m%links(j)%ground) return
      call find_first(above, i, a)
      call find_first(above, j, b)
      above(max(a, b)) = min(a, b)
   end subroutine join

   !> The `first` link of the part of link `i`, as `above` has it so far; the way there is made shorter.
   pure subroutine find_first(above, i, first)
      integer, intent(inout) :: above(:)
      integer, intent(in) :: i
      integer, intent(out) :: first

      first = i
      do while (above(first) /= first)
         above(first) = above(above(first))
         first = above(first)
      end do
   end subroutine find_first

   pure integer function part_of_pair(m, link_part, i) result(part)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: link_part(:), i

      part = max(link_part(m%points(m%pairs(i)%point_i)%link), link_part(m%points(m%pairs(i)%point_j)%link))
   end function part_of_pair

   pure integer function part_of_drive(m, link_part, i) result(part)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: link_part(:), i

      associate (d => m%drives(i))
         select case (d%kind)
         case (drive_angle)
            part = link_part(d%subject)
         case (drive_relangle)
            part = max(link_part(d%subject), link_part(d%second))
         case (drive_x, drive_y)
            part = link_part(m%points(d%subject)%link)
         case default
            part = part_of_pair(m, link_part, d%subject)
         end select
      end associate
   end function part_of_drive

   pure integer function part_of_request(m, link_part, i) result(part)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: link_part(:), i

      associate (subject => m%requests(i)%subject)
         select case (m%requests(i)%kind)
         case (request_link)
            part = link_part(subject)
         case (request_point)
            part = link_part(m%points(subject)%link)
         case default
            part = part_of_pair(m, link_part, subject)
         end select
      end associate
   end function part_of_request

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

   !> Adds to `part` the ground links and their points that its pairs and drives touch. `seen`: all false.
   subroutine add_ground(m, seen, part)
      type(mechanism_t), intent(in) :: m
      logical, intent(inout) :: seen(:)
      type(part_t), intent(inout) :: part
      integer, allocatable :: links(:), points(:)
      integer :: i

      allocate (links(0), points(0))
      do i = 1, size(part%pairs)
         call touch_point(m%pairs(part%pairs(i))%point_i)
         call touch_point(m%pairs(part%pairs(i))%point_j)
      end do
      do i = 1, size(part%drives)
         associate (d => m%drives(part%drives(i)))
            if (d%kind == drive_relangle) call touch_link(d%subject)
            if (d%kind == drive_relangle) call touch_link(d%second)
         end associate
      end do
      seen(links) = .false.
      seen(size(m%links) + points) = .false.
      part%links = merged(part%links, links)
      part%points = merged(part%points, points)

   contains

      subroutine touch_point(k)
         integer, intent(in) :: k

         if (.not. m%links(m%points(k)%link)%ground) return
         call touch_link(m%points(k)%link)
         if (.not. seen(size(m%links) + k)) points = [points, k]
         seen(size(m%links) + k) = .true.
      end subroutine touch_point

      subroutine touch_link(k)
         integer, intent(in) :: k

         if (m%links(k)%ground .and. .not. seen(k)) links = [links, k]
         if (m%links(k)%ground) seen(k) = .true.
      end subroutine touch_link
   end subroutine add_ground

   !> Members of each of so many parts, by the `part` of each.
   pure function sorted(part, parts) result(s)
      integer, intent(in) :: part(:), parts
      type(sorted_t) :: s
      integer :: fill(parts), i

      allocate (s%first(parts + 1), s%member(count(part > 0)))
      fill = 0
      do i = 1, size(part)
         if (part(i) > 0) fill(part(i)) = fill(part(i)) + 1
      end do
      s%first(1) = 1
      do i = 1, parts
         s%first(i + 1) = s%first(i) + fill(i)
      end do
      fill = s%first(:parts)
      do i = 1, size(part)
         if (part(i) == 0) cycle
         s%member(fill(part(i))) = i
         fill(part(i)) = fill(part(i)) + 1
      end do
   end function sorted

   pure function members(s, c) result(list)
      type(sorted_t), intent(in) :: s
      integer, intent(in) :: c
      integer, allocatable :: list(:)

      list = s%member(s%first(c):s%first(c + 1) - 1)
   end function members

   !> The increasing list `a` and the few numbers `b` in one increasing list.
   pure function merged(a, b) result(list)
      integer, intent(in) :: a(:), b(:)
      integer, allocatable :: list(:)
      integer :: rest(size(b)), i, k, n

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
         if (k > size(b)) then
            list(n) = a(i)
            i = i + 1
         else if (i > size(a)) then
            list(n) = rest(k)
            k = k + 1
         else if (a(i) < rest(k)) then
            list(n) = a(i)
            i = i + 1
         else
            list(n) = rest(k)
            k = k + 1
         end if
      end do
   end function merged
end module independent
