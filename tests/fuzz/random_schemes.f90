!> Tests. A kinematic scheme of its seed alone: of twenty seeds fifteen are chains of dyads, four have triads, tetrads
!> and links with several degrees of freedom, and one has a group of 12 to 18 links.
module random_schemes
   use kinds, only: wp
   use disjoint_sets, only: joined
   use quad_jet, only: qp
   use dice, only: dice_t, new_dice, throw, chance, between, magnitude
   use mechanism, only: measure_line, measure_angle, measure_xi, measure_sum, drive_angle, drive_relangle, drive_x, &
      drive_y
   use schemes, only: scheme_t, pair_t, measure_t, drive_t, angle_unit, link_at, double
   use scheme_builder, only: builder_t, new_builder, number, square, add_link, add_point, world, end_group, shuffle
   use scheme_groups, only: add_crank, add_slider, add_dyad, add_plates, add_net, add_open_chain, add_floating, &
      add_cylinder, add_table, add_ring, add_parallelogram
   implicit none
   private
   public :: random_scheme, class_of, surplus_scheme, add_measures

   enum, bind(c)
      enumerator :: class_dyads = 1, class_triads, class_wide
   end enum
   integer, parameter :: tries = 30

contains

   pure integer function class_of(seed)
      integer, intent(in) :: seed

      select case (modulo(seed, 20))
      case (0)
         class_of = class_wide
      case (1, 6, 11, 16)
         class_of = class_triads
      case default
         class_of = class_dyads
      end select
   end function class_of

   !> Scheme number `seed`; a deck may have several, `set` 1, 2 ...
   function random_scheme(seed, set) result(s)
      integer, intent(in) :: seed, set
      type(scheme_t) :: s
      type(builder_t), allocatable :: d
      integer :: k, parts, ground

      allocate (d)
      d = new_builder(new_dice(seed + 1000000000*(set - 1)))
      call begin_scheme(d, seed)
      parts = merge(2, 1, chance(d%dice, 0.15_wp))
      do k = 1, parts
         d%part = k
         d%scale = magnitude(d%dice, merge(6, 1, chance(d%dice, 0.5_wp)))
         d%size = d%scale
         d%first_link = size(d%s%links) + 1
         ground = add_link(d, .true.)
         if (chance(d%dice, 0.3_wp)) ground = add_link(d, .true.)
         call add_part(d, merge(class_of(seed), class_dyads, k == 1))
      end do
      call end_scheme(d)
      s = d%s
   end function random_scheme

   !> Up to six measures of one independent mechanism of `s`, by dice of their own. Their rows are printed, so that a
   !> scheme of which only some links are has none.
   subroutine add_measures(s, seed)
      type(scheme_t), intent(inout) :: s
      integer, intent(in) :: seed
      type(dice_t) :: dice
      type(measure_t), allocatable :: list(:)
      type(measure_t) :: one
      integer, allocatable :: points(:), links(:), alike(:), parts(:)
      integer :: part, k, i, n

      if (allocated(s%printed)) return
      dice = new_dice(seed + 700000000)
      associate (relative => s%drives%kind == drive_relangle)
         parts = joined(.not. s%links%ground, &
            [s%points(s%pairs%point_i)%link, pack(s%drives%subject, relative)], &
            [s%points(s%pairs%point_j)%link, pack(s%drives%second, relative)])
      end associate
      part = throw(dice, max(1, maxval(parts)))
      points = pack([(i, i=1, size(s%points))], [(belongs(s%points(i)%link), i=1, size(s%points))])
      links = pack([(i, i=1, size(s%links))], [(belongs(i) .and. any(s%points%link == i), i=1, size(s%links))])
      if (min(size(points), size(links)) < 2) return
      allocate (list(0))
      n = throw(dice, 6)
      do k = 1, n
         one = measure_t(kind=throw(dice, measure_sum))
         one%is_angle = any(one%kind == [measure_line, measure_angle])
         select case (one%kind)
         case (measure_angle)
            do
               do i = 1, 2
                  alike = pack([(n, n=1, size(list))], list%kind == measure_line)
                  one%of_line(i) = chance(dice, 0.6_wp) .and. size(alike) > 0
                  one%subjects(i) = links(throw(dice, size(links)))
                  if (one%of_line(i)) one%subjects(i) = alike(throw(dice, size(alike)))
               end do
               if (one%subjects(1) /= one%subjects(2) .or. (one%of_line(1) .neqv. one%of_line(2))) exit
            end do
         case (measure_sum)
            if (size(list) == 0) cycle
            one%subjects(1) = throw(dice, size(list))
            one%is_angle = list(one%subjects(1))%is_angle
            alike = pack([(i, i=1, size(list))], list%is_angle .eqv. one%is_angle)
            one%subjects(2) = alike(throw(dice, size(alike)))
            ! Whole turns stay whole turns.
            one%factors = real([throw(dice, 3), throw(dice, 3)] - 2, qp)
            if (.not. one%is_angle) one%factors = [number_between(-2.0_wp, 2.0_wp), number_between(-2.0_wp, 2.0_wp)]
            one%constant = number_between(-1.0_wp, 1.0_wp)
         case default
            one%subjects(1) = points(throw(dice, size(points)))
            do
               one%subjects(2) = points(throw(dice, size(points)))
               if (one%subjects(2) /= one%subjects(1)) exit
            end do
            if (one%kind >= measure_xi) one%subjects(2) = links(throw(dice, size(links)))
         end select
         list = [list, one]
      end do
      if (size(list) > 0) s%measures = list

   contains

      logical function belongs(link)
         integer, intent(in) :: link

         belongs = any(parts(link) == [0, part])
      end function belongs

      real(qp) function number_between(low, high)
         real(wp), intent(in) :: low, high

         number_between = double(real(between(dice, low, high), qp))
      end function number_between
   end subroutine add_measures

   !> A small scheme of seed number `seed`, by METHOD NEWTON. `has_surplus`: with equations that say again what others
   !> say, after those of the scheme without them. Some decks with surplus have 12 digits: then equations contradict
   !> one another by their rounding.
   function surplus_scheme(seed, has_surplus) result(s)
      integer, intent(in) :: seed
      logical, intent(in) :: has_surplus
      type(scheme_t) :: s
      type(builder_t), allocatable :: d
      integer, parameter :: kinds(6) = [3, 3, 3, 5, 6, 13]
      integer :: k, points, pairs

      allocate (d)
      d = new_builder(new_dice(seed + 500000000))
      call begin_scheme(d, seed)
      d%scale = magnitude(d%dice, merge(6, 1, chance(d%dice, 0.5_wp)))
      d%size = d%scale
      k = add_link(d, .true.)
      call add_some(d, throw(d%dice, 2), class_dyads)
      do k = 1, throw(d%dice, 3) - 1
         call add_some(d, kinds(throw(d%dice, size(kinds))), class_dyads)
      end do
      call end_scheme(d)
      points = size(d%s%points)
      pairs = size(d%s%pairs)
      if (has_surplus) then
         do k = 1, throw(d%dice, 2)
            call add_surplus(d)
         end do
         if (chance(d%dice, 0.25_wp)) d%s%digits = 12
      end if
      s = d%s
      s%method = ''
      s%point_order = [s%point_order, [(k, k=points + 1, size(s%points))]]
      s%pair_order = [s%pair_order, [(k, k=pairs + 1, size(s%pairs))]]
   end function surplus_scheme

   !> Equations more by the dice; of seven kinds six have the motion of those that are there.
   subroutine add_surplus(d)
      type(builder_t), intent(inout) :: d
      integer :: k

      select case (throw(d%dice, 7))
      case (1, 2, 3)
         call add_parallel_guide(d)
      case (4)
         k = throw(d%dice, size(d%s%pairs))
         d%s%pairs = [d%s%pairs, d%s%pairs(k)]
      case (5, 6)
         call repeat_drive(d)
      case default
         call drive_a_point(d)
      end select
   end subroutine add_surplus

   !> A prismatic pair once more, between other points of its links.
   subroutine add_parallel_guide(d)
      type(builder_t), intent(inout) :: d
      type(pair_t) :: pair
      real(qp) :: where(2), e(2), theta
      integer :: k, links(2)

      if (.not. any(d%s%pairs%prismatic)) return
      do
         k = throw(d%dice, size(d%s%pairs))
         if (d%s%pairs(k)%prismatic) exit
      end do
      pair = d%s%pairs(k)
      links = [link_at(d%s, pair%point_i), link_at(d%s, pair%point_j)]
      where = world(d, pair%point_i) + d%scale*square(d, 1.0_qp)
      pair%point_i = add_point(d, links(1), where)
      where = where + d%scale*square(d, 1.0_qp)
      pair%point_j = add_point(d, links(2), where)
      theta = d%b(links(1))%phi%v + pair%alpha*angle_unit(d%s)
      e = world(d, pair%point_i) - world(d, pair%point_j)
      pair%h = double(e(2)*cos(theta) - e(1)*sin(theta))
      d%s%pairs = [d%s%pairs, pair]
   end subroutine add_parallel_guide

   !> A drive once more, of an angle also by the angle to a ground link.
   subroutine repeat_drive(d)
      type(builder_t), intent(inout) :: d
      type(drive_t) :: drive
      integer :: k, ground

      k = throw(d%dice, size(d%s%drives))
      drive = d%s%drives(k)
      if (drive%kind == drive_angle .and. chance(d%dice, 0.5_wp)) then
         ground = findloc(d%s%links%ground, .true., dim=1)
         drive%kind = drive_relangle
         drive%second = drive%subject
         drive%subject = ground
         drive%law%polynomial(1) = double(drive%law%polynomial(1) - d%s%links(ground)%at(3)/angle_unit(d%s))
      end if
      d%s%drives = [d%s%drives, drive]
   end subroutine repeat_drive

   !> A coordinate of a point, held where it is: the drives give its place already, and move it elsewhere.
   subroutine drive_a_point(d)
      type(builder_t), intent(inout) :: d
      type(drive_t) :: drive
      real(qp) :: place(2)

      drive%kind = merge(drive_x, drive_y, chance(d%dice, 0.5_wp))
      drive%subject = throw(d%dice, size(d%s%points))
      if (d%s%links(link_at(d%s, drive%subject))%ground) return
      place = world(d, drive%subject)
      drive%law%polynomial(1) = double(place(merge(1, 2, drive%kind == drive_x)))
      d%s%drives = [d%s%drives, drive]
   end subroutine drive_a_point

   !> Time, units and method.
   subroutine begin_scheme(d, seed)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: seed
      real(qp) :: span, start
      character(8) :: by_dice
      integer :: length

      associate (s => d%s)
         s%seed = seed
         s%degrees = chance(d%dice, 0.5_wp)
         if (chance(d%dice, 0.2_wp)) d%special = 0.5_wp
         span = magnitude(d%dice, 2)
         start = 0.0_qp
         if (chance(d%dice, 0.4_wp)) start = span*number(d, -1.0_qp, 3.0_qp)
         s%steps = throw(d%dice, 9) + 1
         s%t0 = double(start)
         s%t1 = double(start + span)
         d%from = s%t0
         d%to = s%t1
         s%span = span
         if (chance(d%dice, 0.1_wp)) then
            s%t0 = d%to
            s%t1 = d%from
         end if
         d%t = s%t0
         if (chance(d%dice, 0.1_wp)) call add_instants(d)
         ! Long tables show what is lost in one row of a thousand.
         if (modulo(seed, 9) == 2) s%steps = 16*s%steps
         by_dice = ''
         if (chance(d%dice, 0.12_wp)) by_dice = merge('DENSE   ', 'MATRIX  ', chance(d%dice, 0.8_wp))
         ! All by one method, if the environment names it; redundant equations still take METHOD NEWTON.
         call get_environment_variable('FUZZ_METHOD', s%method, length)
         if (length == 0) s%method = by_dice
      end associate
   end subroutine begin_scheme

   !> AT cards behind TIME, or in its place.
   subroutine add_instants(d)
      type(builder_t), intent(inout) :: d
      integer :: k

      do k = 1, throw(d%dice, 4)
         d%s%at = [d%s%at, double(number(d, d%from, d%to))]
      end do
      if (chance(d%dice, 0.7_wp)) return
      d%s%steps = 0
      d%t = d%s%at(1)
   end subroutine add_instants

   !> An independent mechanism: driven links, and groups on these.
   subroutine add_part(d, class)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: class
      integer :: k, groups

      call add_some(d, 1, class)
      groups = throw(d%dice, merge(4, 7, class == class_wide))
      do k = 1, groups
         if (class == class_wide .and. k == 1) then
            call add_some(d, merge(14, 15, chance(d%dice, 0.5_wp)), class)
            if (chance(d%dice, 0.3_wp)) call add_some(d, merge(17, 18, chance(d%dice, 0.5_wp)), class)
         else if (class /= class_triads) then
            call add_some(d, merge(3, throw(d%dice, 2), chance(d%dice, 0.8_wp)), class)
         else
            call add_some(d, throw(d%dice, 12), class)
         end if
         if (chance(d%dice, 0.06_wp)) call add_some(d, merge(13, 16, chance(d%dice, 0.5_wp)), class)
      end do
   end subroutine add_part

   !> A group of a kind by its number, at the first place where it is not near a singularity.
   subroutine add_some(d, kind, class)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: kind, class
      type(builder_t), allocatable :: before
      type(dice_t) :: dice
      real(qp) :: way
      logical :: kept
      integer :: k

      allocate (before)
      do k = 1, tries
         before = d
         call choose_region(d)
         way = number(d, 0.05_qp, merge(0.3_qp, 0.8_qp, class == class_wide))
         if (class == class_dyads .and. chance(d%dice, 0.2_wp)) way = number(d, 1.0_qp, 8.0_qp)
         call add_kind(d, kind, way)
         call end_group(d, kept)
         if (kept) exit
         dice = d%dice
         d = before
         d%dice = dice
      end do
   end subroutine add_some

   subroutine add_kind(d, kind, way)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: kind
      real(qp), intent(in) :: way

      select case (kind)
      case (1); call add_crank(d, way)
      case (2); call add_slider(d, min(way, 0.8_qp))
      case (3, 4); call add_dyad(d)
      case (5, 6); call add_plates(d, 1)
      case (7); call add_net(d)
      case (8); call add_plates(d, 2)
      case (9); call add_open_chain(d, min(way, 0.8_qp))
      case (10); call add_floating(d, min(way, 0.8_qp))
      case (11); call add_cylinder(d, min(way, 0.8_qp))
      case (12); call add_table(d, min(way, 0.8_qp))
      case (13); call add_parallelogram(d, throw(d%dice, 3) + 1, min(10.0_qp*way, 8.0_qp), .false., .false.)
      case (16)
         ! A BRANCH card is for the change points of one way in time, and for METHOD NEWTON.
         call add_parallelogram(d, 2, min(10.0_qp*way, 8.0_qp), size(d%s%at) == 0 .and. d%s%method == '', .false.)
      case (17, 18); call add_parallelogram(d, 9 + throw(d%dice, 6), min(10.0_qp*way, 8.0_qp), .false., kind == 17)
      case (14); call add_plates(d, 4 + throw(d%dice, 4))
      case default; call add_ring(d, 10 + 2*throw(d%dice, 4))
      end select
   end subroutine add_kind

   !> Few groups are much smaller than the others.
   subroutine choose_region(d)
      type(builder_t), intent(inout) :: d

      d%size = d%scale
      d%centre = 0.0_qp
      if (.not. chance(d%dice, 0.04_wp)) return
      d%centre = d%scale*square(d, 3.0_qp)
      d%size = d%scale*10.0_qp**number(d, -3.0_qp, -0.5_qp)
   end subroutine choose_region

   !> What is left: estimates, orders, what is printed, pairs that are there twice.
   subroutine end_scheme(d)
      type(builder_t), intent(inout) :: d
      integer :: k, twice

      associate (s => d%s)
         call estimate_links(d)
         twice = 0
         if (chance(d%dice, 0.05_wp) .and. size(s%pairs) > 0) twice = throw(d%dice, size(s%pairs))
         if (twice > 0) s%pairs = [s%pairs, s%pairs(twice)]
         if (twice > 0 .or. any(s%groups%redundant)) s%method = ''
         call shuffle(d)
         s%print = merge('ALL  ', 'LINKS', chance(d%dice, 0.2_wp))
         if (s%print == 'LINKS' .and. chance(d%dice, 0.1_wp)) then
            allocate (s%printed(0))
            do k = 1, size(s%links)
               if (chance(d%dice, 0.3_wp) .and. .not. s%links(k)%ground) s%printed = [s%printed, k]
            end do
            if (size(s%printed) == 0) deallocate (s%printed)
         end if
      end associate
   end subroutine end_scheme

   !> The estimates of the deck: the assembly with all its digits, or near it.
   subroutine estimate_links(d)
      type(builder_t), intent(inout) :: d
      real(qp) :: off
      integer :: k, c

      off = 0.0_qp
      if (chance(d%dice, 0.4_wp)) off = min(0.03_qp, 0.05_qp/d%inverse)*10.0_qp**number(d, -3.0_qp, 0.0_qp)
      do k = 1, size(d%s%links)
         associate (link => d%s%links(k))
            link%estimate = link%at
            if (link%ground .or. .not. off > 0.0_qp) cycle
            do c = 1, 3
               link%estimate(c) = link%estimate(c) + off*number(d, -1.0_qp, 1.0_qp) &
                  *merge(1.0_qp, d%s%groups(link%group)%scale, c == 3)
            end do
         end associate
      end do
   end subroutine estimate_links
end module random_schemes
