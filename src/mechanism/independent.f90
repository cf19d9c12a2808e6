!> The independent mechanisms of a set: links that pairs or drives join, but not through the ground. None of them acts
!> on another: each is solved as a mechanism of its own, in its own numbers and its own lengths. What the set keeps are
!> its settings, and where its rows and drives are, in the order of the cards.
module independent
   use grouping, only: sorted, sorted_numbers, sorted_t, members, once, joined
   use kinds, only: wp
   use mechanism, only: settings_t, mechanism_t, request_t, tolerance_t, pair_links, drive_links, request_links, &
      drive_relangle, driven_kinds, request_link, request_point, request_pair, request_pole, request_curve, &
      number_link, number_pair
   use scales, only: characteristic_length, characteristic_rate, relative_tolerance
   implicit none
   private
   public :: set_t, member_t, part_t, divide, part_of_links, &
      request_of, first_drive

   !> A row or drive of a set: the number of its part, and its number there.
   type :: member_t
      integer :: part = 1, number = 0
   end type member_t

   !> The numbers in the deck of what a part has, increasing; the place in the list is the number in the part.
   type :: part_t
      integer, allocatable :: links(:), points(:), pairs(:), drives(:), requests(:), branch_requests(:)
   end type part_t

   !> A set, divided. Of several mechanisms the ground is a part too, number 0, with the rows that are about it alone.
   type, extends(settings_t) :: set_t
      integer :: count = 1                          !< of independent mechanisms
      type(mechanism_t), allocatable :: parts(:)    !< (1), or (0:count)
      type(member_t), allocatable :: rows(:), drives(:)   !< in the order of the cards
      type(part_t), allocatable :: cards(:)         !< (parts) their links alone, for pictures
      real(wp) :: largest_tolerance = 0.0_wp        !< as a part of the whole's sizes; 0: no number has a tolerance
   end type set_t

contains

   !> Divides the set `m` into its parts: `s`. A part has the ground links, and their points, that its pairs, drives and
   !> rows use. A BRANCH card without a link is for every part. Time and memory grow in proportion to the deck.
   subroutine divide(m, s)
      type(mechanism_t), intent(in) :: m
      type(set_t), intent(out) :: s
      type(sorted_t) :: links, points, pairs, drives, rows
      type(part_t) :: place, part
      integer, allocatable :: pair_part(:), drive_part(:), row_part(:), user(:), used(:)
      integer :: link_part(size(m%links)), ground, i, c, k

      s%settings_t = m%settings_t
      if (allocated(m%tolerances)) s%largest_tolerance = relative_tolerance(m)
      link_part = part_of_links(m)
      s%count = max(1, maxval([0, link_part]))
      if (s%count == 1) link_part = 1
      ground = s%count + 1
      pair_part = [(part_of(pair_links(m, m%pairs(i))), i=1, size(m%pairs))]
      drive_part = [(part_of(drive_links(m, m%drives(i))), i=1, size(m%drives))]
      row_part = [(part_of(request_links(m, m%requests(i))), i=1, size(m%requests))]
      pairs = sorted(pair_part, ground)
      drives = sorted(drive_part, ground)
      rows = sorted(row_part, ground)
      ! Each point, and each link, with the part that it belongs to or that uses it.
      associate (of_points => pack([(i, i=1, size(m%requests))], &
                                   m%requests%kind == request_point .or. m%requests%kind == request_curve))
         used = [(i, i=1, size(m%points)), m%pairs%point_i, m%pairs%point_j, m%requests(of_points)%subject]
         user = [link_part(m%points%link), pair_part, pair_part, row_part(of_points)]
      end associate
      points = sorted_numbers(used, user, ground)
      used = [(i, i=1, size(m%links)), m%points(used)%link, (drive_links(m, m%drives(i)), i=1, size(m%drives)), &
         (request_links(m, m%requests(i)), i=1, size(m%requests))]
      user = [link_part, user, (spread(drive_part(i), 1, 3), i=1, size(m%drives)), &
         (spread(row_part(i), 1, 3), i=1, size(m%requests))]
      links = sorted_numbers(used, user, ground)

      associate (first => merge(1, 0, s%count == 1))
         allocate (s%parts(first:s%count), s%cards(first:s%count))
      end associate
      allocate (s%rows(size(m%requests)), s%drives(size(m%drives)))
      allocate (place%links(size(m%links)), place%points(size(m%points)), place%pairs(size(m%pairs)), &
         place%drives(size(m%drives)), source=0)
      do c = 1, size(s%parts)
         k = modulo(c, ground)
         part%links = once(members(links, c))
         part%points = once(members(points, c))
         part%pairs = members(pairs, c)
         part%drives = members(drives, c)
         part%requests = members(rows, c)
         part%branch_requests = [integer ::]
         if (allocated(m%branch_requests)) part%branch_requests = pack([(i, i=1, size(m%branch_requests))], &
            [(m%branch_requests(i)%link == 0 .or. link_part(max(1, m%branch_requests(i)%link)) == c, &
            i=1, size(m%branch_requests))])
         s%rows(part%requests) = [(member_t(k, i), i=1, size(part%requests))]
         s%drives(part%drives) = [(member_t(k, i), i=1, size(part%drives))]
         call take_mechanism(m, part, place, s%parts(k))
         call move_alloc(part%links, s%cards(k)%links)
      end do

   contains

      !> The part of what has these `links`.
      pure integer function part_of(links)
         integer, intent(in) :: links(:)

         part_of = maxval(link_part(links))
         if (part_of == 0) part_of = ground
      end function part_of
   end subroutine divide

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

   !> Takes the `part` of `m` as a mechanism of its own, without its cards: `own`. `place`: zeros, one for each link,
   !> point, pair and drive of `m`, before and after. Reason: of many parts each takes the time of its own size alone.
   subroutine take_mechanism(m, part, place, own)
      type(mechanism_t), intent(in) :: m
      type(part_t), intent(in) :: part
      type(part_t), intent(inout) :: place
      type(mechanism_t), intent(out) :: own
      integer, parameter :: kinds(number_link:number_pair) = [request_link, request_point, request_point, request_pair]
      integer :: i

      place%links(part%links) = [(i, i=1, size(part%links))]
      place%points(part%points) = [(i, i=1, size(part%points))]
      place%pairs(part%pairs) = [(i, i=1, size(part%pairs))]
      place%drives(part%drives) = [(i, i=1, size(part%drives))]
      own%settings_t = m%settings_t
      own%links = m%links(part%links)
      own%points = m%points(part%points)
      own%points%link = place%links(own%points%link)
      own%pairs = m%pairs(part%pairs)
      own%pairs%point_i = place%points(own%pairs%point_i)
      own%pairs%point_j = place%points(own%pairs%point_j)

      own%drives = m%drives(part%drives)
      do i = 1, size(own%drives)
         associate (d => own%drives(i))
            d%subject = place_of(driven_kinds(d%kind), d%subject)
            if (d%kind == drive_relangle) d%second = place%links(d%second)
         end associate
      end do
      own%requests = m%requests(part%requests)
      do i = 1, size(own%requests)
         associate (request => own%requests(i))
            request%subject = place_of(request%kind, request%subject)
            if (request%second > 0) request%second = place%links(request%second)
         end associate
      end do
      allocate (own%branch_requests(size(part%branch_requests)))
      do i = 1, size(part%branch_requests)
         associate (request => own%branch_requests(i))
            request = m%branch_requests(part%branch_requests(i))
            request%card = part%branch_requests(i)
            if (request%link > 0) request%link = place%links(request%link)
         end associate
      end do

      if (allocated(m%tolerances)) then
         own%tolerances = m%tolerances
         do i = 1, size(own%tolerances)
            associate (one => own%tolerances(i))
               if (one%kind > number_pair) then
                  one%subject = place%drives(one%subject)
               else
                  one%subject = place_of(kinds(one%kind), one%subject)
               end if
            end associate
         end do
         own%tolerances = pack(own%tolerances, own%tolerances%subject > 0)
      end if
      if (any(own%requests%kind >= request_pole)) then
         own%requests%length = characteristic_length(own)
         own%requests%rate = characteristic_rate(own, own%requests(1)%length)
      end if
      place%links(part%links) = 0
      place%points(part%points) = 0
      place%pairs(part%pairs) = 0
      place%drives(part%drives) = 0

   contains

      !> The number in the part of the link, point or pair (`kind`: request_link, ...) number `i` of the deck.
      pure integer function place_of(kind, i)
         integer, intent(in) :: kind, i

         select case (kind)
         case (request_link, request_pole)
            place_of = place%links(i)
         case (request_point, request_curve)
            place_of = place%points(i)
         case default
            place_of = place%pairs(i)
         end select
      end function place_of
   end subroutine take_mechanism

   !> What row number `i` of `s` is asked for.
   pure type(request_t) function request_of(s, i)
      class(set_t), intent(in) :: s
      integer, intent(in) :: i

      request_of = s%parts(s%rows(i)%part)%requests(s%rows(i)%number)
   end function request_of

   !> The number among all drives of `s` of the first one of the mechanism that row number `i` is about; 0: it has none.
   pure integer function first_drive(s, i)
      class(set_t), intent(in) :: s
      integer, intent(in) :: i

      first_drive = findloc(s%drives%part, s%rows(i)%part, dim=1)
   end function first_drive
end module independent
