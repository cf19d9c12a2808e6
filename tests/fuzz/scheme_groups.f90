!> Tests. Groups of links by the dice: driven links, dyads of all five forms, triads, tetrads, chains and rings of 12 to
!> 18 links, parallelograms, and links with several degrees of freedom with as many drives.
module scheme_groups
   use kinds, only: wp
   use quad_jet, only: qp, pi_q
   use dice, only: throw, chance
   use mechanism, only: drive_angle, drive_relangle, drive_x, drive_y, drive_slide
   use schemes, only: form_any, form_rrr, form_rrp, form_rpr, form_prp, form_rpp, form_parallelogram, double, point_t, &
      pair_t, set_trigonometry
   use scheme_builder, only: builder_t, number, square, anywhere, add_link, add_links, join, pick_base, place_on_base, &
      begin_group
   use scheme_drives, only: add_drive, add_point_drive, set_steady
   implicit none
   private
   public :: add_crank, add_slider, add_dyad, add_plates, add_net, add_open_chain, add_floating, add_cylinder, &
      add_table, add_ring, add_parallelogram

contains

   !> A link that turns on another, driven by its angle or by that between the two; few go through whole turns, on a
   !> short arm.
   subroutine add_crank(d, amplitude)
      type(builder_t), intent(inout) :: d
      real(qp), intent(in) :: amplitude
      integer :: base, l
      real(qp) :: where(2)

      call begin_group(d, form_any)
      base = pick_base(d)
      where = place_on_base(d, base)
      l = add_link(d, .false.)
      call join(d, base, l, .false., where)
      if (amplitude > 1.0_qp) then
         d%s%links(l)%centre = where
         d%s%links(l)%reach = d%size*number(d, 0.1_qp, 0.6_qp)
      end if
      if (chance(d%dice, 0.6_wp)) then
         call add_drive(d, drive_angle, l, 0, amplitude)
      else
         if (chance(d%dice, 0.3_wp)) base = pick_base(d)
         if (chance(d%dice, 0.5_wp)) then
            call add_drive(d, drive_relangle, base, l, amplitude)
         else
            call add_drive(d, drive_relangle, l, base, amplitude)
         end if
      end if
   end subroutine add_crank

   !> A link that slides on another, driven by its slide or by a coordinate.
   subroutine add_slider(d, amplitude)
      type(builder_t), intent(inout) :: d
      real(qp), intent(in) :: amplitude
      integer :: base, l

      call begin_group(d, form_any)
      base = pick_base(d)
      l = add_link(d, .false.)
      call join(d, base, l, .true., place_on_base(d, base))
      select case (throw(d%dice, 4))
      case (1)
         call add_point_drive(d, drive_x, l, amplitude*d%size)
      case (2)
         call add_point_drive(d, drive_y, l, amplitude*d%size)
      case default
         call add_drive(d, drive_slide, size(d%s%pairs), 0, amplitude*d%size)
      end select
   end subroutine add_slider

   subroutine add_dyad(d)
      type(builder_t), intent(inout) :: d
      character(3), parameter :: words(5) = ['RRR', 'RRP', 'RPR', 'PRP', 'RPP']
      integer, parameter :: forms(5) = [form_rrr, form_rrp, form_rpr, form_prp, form_rpp]
      integer :: which, e, f, first

      which = throw(d%dice, 7)
      if (which > 5) which = 1
      call begin_group(d, forms(which))
      e = pick_base(d)
      f = pick_base(d)
      first = add_links(d, 2, .false.)
      associate (w => words(which))
         call join(d, e, first, w(1:1) == 'P', place_on_base(d, e))
         call join(d, first, first + 1, w(2:2) == 'P', anywhere(d))
         call join(d, first + 1, f, w(3:3) == 'P', place_on_base(d, f))
      end associate
   end subroutine add_dyad

   !> `n` plates in a row, each on a leg, the first and the last on two: a triad for 1, 2 n + 2 links. A leg has two
   !> revolute pairs, or one of them and a prismatic one.
   subroutine add_plates(d, n)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: n
      integer :: plate, before, k, i
      real(qp) :: last(2), step(2)

      call begin_group(d, form_any)
      last = anywhere(d)
      plate = 0
      do k = 1, n
         before = plate
         plate = add_link(d, .false.)
         step = d%size*[number(d, 0.7_qp, 2.0_qp), number(d, -1.0_qp, 1.0_qp)]
         if (k > 1) call join(d, before, plate, .false., last)
         do i = 1, merge(2, 1, k == 1 .or. k == n) + merge(1, 0, n == 1)
            call add_leg(d, plate, last + step*number(d, 0.0_qp, 1.0_qp) &
               + d%size*square(d, 1.0_qp))
         end do
         last = last + step
      end do
   end subroutine add_plates

   !> A leg from `where` on `plate` to a link outside the group.
   subroutine add_leg(d, plate, where)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: plate
      real(qp), intent(in) :: where(2)
      integer :: base, l, slide
      real(qp) :: foot(2)

      base = pick_base(d)
      l = add_link(d, .false.)
      slide = throw(d%dice, 6)
      foot = where + d%size*square(d, 2.0_qp)
      if (d%s%links(base)%reach < d%size) foot = place_on_base(d, base)
      call join(d, plate, l, slide == 1, where)
      call join(d, l, base, slide == 2, foot)
   end subroutine add_leg

   !> Four links in a ring, two of them on others.
   subroutine add_net(d)
      type(builder_t), intent(inout) :: d
      integer :: e, f, first, k, slide

      call begin_group(d, form_any)
      e = pick_base(d)
      f = pick_base(d)
      first = add_links(d, 4, .false.)
      slide = throw(d%dice, 12)
      do k = 0, 3
         call join(d, first + k, first + modulo(k + 1, 4), slide == k + 1, anywhere(d))
      end do
      call join(d, e, first, .false., place_on_base(d, e))
      call join(d, first + 2, f, .false., place_on_base(d, f))
   end subroutine add_net

   !> `n` links in a ring, every second one on a link outside.
   subroutine add_ring(d, n)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: n
      integer :: k, first, base
      real(qp) :: middle(2), p(2), radius

      call begin_group(d, form_any)
      middle = anywhere(d)
      radius = d%size*n/6.0_qp
      first = add_links(d, n, .false.)
      do k = 0, n - 1
         p = middle + radius*[cos(2.0_qp*pi_q*k/n), sin(2.0_qp*pi_q*k/n)]
         p = p + 0.4_qp*d%size*square(d, 1.0_qp)
         call join(d, first + k, first + modulo(k + 1, n), chance(d%dice, 0.03_wp), p)
         if (modulo(k, 2) == 1) cycle
         base = pick_base(d)
         p = p + d%size*square(d, 1.0_qp)
         if (d%s%links(base)%reach < d%size) p = place_on_base(d, base)
         call join(d, base, first + k, .false., p)
      end do
   end subroutine add_ring

   !> Three links in a row between two others, driven somewhere.
   subroutine add_open_chain(d, amplitude)
      type(builder_t), intent(inout) :: d
      real(qp), intent(in) :: amplitude
      integer :: e, f, first, slide

      call begin_group(d, form_any)
      e = pick_base(d)
      f = pick_base(d)
      first = add_links(d, 3, .false.)
      slide = throw(d%dice, 6)
      call join(d, e, first, slide == 1, place_on_base(d, e))
      call join(d, first, first + 1, slide == 2, anywhere(d))
      call join(d, first + 1, first + 2, slide == 3, anywhere(d))
      call join(d, first + 2, f, slide == 4, place_on_base(d, f))
      select case (throw(d%dice, 5))
      case (1)
         call add_drive(d, drive_angle, first + 1, 0, amplitude)
      case (2)
         call add_drive(d, drive_relangle, first, first + 2, amplitude)
      case (3)
         call add_point_drive(d, drive_x, first + 1, amplitude*d%size)
      case (4)
         call add_point_drive(d, drive_y, first, amplitude*d%size)
      case default
         if (slide <= 4) call add_drive(d, drive_slide, size(d%s%pairs) - 4 + slide, 0, amplitude*d%size)
         if (slide > 4) call add_point_drive(d, drive_y, first + 1, amplitude*d%size)
      end select
   end subroutine add_open_chain

   !> A link on no other: x and y of one of its points are driven, and an angle or a coordinate of another point.
   subroutine add_floating(d, amplitude)
      type(builder_t), intent(inout) :: d
      real(qp), intent(in) :: amplitude
      integer :: l, base

      call begin_group(d, form_any)
      l = add_link(d, .false.)
      call add_point_drive(d, drive_x, l, amplitude*d%size)
      call add_drive(d, drive_y, size(d%s%points), 0, amplitude*d%size)
      base = pick_base(d)
      select case (throw(d%dice, 4))
      case (1)
         call add_drive(d, drive_angle, l, 0, amplitude)
      case (2)
         call add_drive(d, drive_relangle, base, l, amplitude)
      case (3)
         call add_point_drive(d, drive_x, l, amplitude*d%size)
      case default
         call add_point_drive(d, drive_y, l, amplitude*d%size)
      end select
   end subroutine add_floating

   !> A link moved by a cylinder.
   subroutine add_cylinder(d, amplitude)
      type(builder_t), intent(inout) :: d
      real(qp), intent(in) :: amplitude
      integer :: e, f, first
      real(qp) :: p(2)

      call begin_group(d, form_any)
      e = pick_base(d)
      f = pick_base(d)
      first = add_links(d, 3, .false.)
      p = anywhere(d)
      call join(d, e, first, .false., place_on_base(d, e))
      call join(d, first, first + 1, .false., p)
      call join(d, first + 2, f, .false., place_on_base(d, f))
      call join(d, first + 1, first + 2, .true., p)
      call add_drive(d, drive_slide, size(d%s%pairs), 0, amplitude*d%size)
   end subroutine add_cylinder

   !> Two slides one upon the other, driven as slides, or the upper one along x and y.
   subroutine add_table(d, amplitude)
      type(builder_t), intent(inout) :: d
      real(qp), intent(in) :: amplitude
      integer :: e, first

      call begin_group(d, form_any)
      e = pick_base(d)
      first = add_links(d, 2, .false.)
      call join(d, e, first, .true., place_on_base(d, e))
      call join(d, first, first + 1, .true., anywhere(d))
      if (chance(d%dice, 0.5_wp)) then
         call add_drive(d, drive_slide, size(d%s%pairs) - 1, 0, amplitude*d%size)
         call add_drive(d, drive_slide, size(d%s%pairs), 0, amplitude*d%size)
      else
         call add_point_drive(d, drive_x, first + 1, amplitude*d%size)
         call add_drive(d, drive_y, size(d%s%points), 0, amplitude*d%size)
      end if
   end subroutine add_table

   !> A parallelogram of `bars` bars on a link, in numbers whose sums are exact; two of them may take the other branch
   !> past a change point. Where more of them stand `in_line`, they all come to it at once.
   subroutine add_parallelogram(d, bars, way, branches, in_line)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: bars
      real(qp), intent(in) :: way
      logical, intent(in) :: branches, in_line
      integer :: base, first, k, l
      real(qp) :: pivot(2), arm(2, bars), length, unit

      call begin_group(d, form_parallelogram)
      base = pick_base(d)
      unit = 2.0_qp**(exponent(d%size) - 20)
      pivot = unit*anint(d%size/unit*square(d, 2.0_qp))
      arm(:, 1) = 0.0_qp
      do k = 2, bars
         arm(:, k) = unit*anint(d%size/unit*[number(d, 0.5_qp, 2.0_qp), number(d, -1.5_qp, 1.5_qp)]*(-1)**k)
         if (in_line) arm(:, k) = arm(:, 2)*(k/2)*(-1)**k
      end do
      length = double(d%size*number(d, 0.5_qp, 2.0_qp))
      first = add_links(d, bars + 1, .false.)
      ! Bar 1, coupler, bar 2 and further bars.
      call lay_parallelogram(d, base, first, bars, pivot, arm, length)
      do k = 1, bars
         l = first + merge(0, k, k == 1)
         d%s%points = [d%s%points, point_t(base, pivot + arm(:, k)), point_t(l, [0.0_qp, 0.0_qp]), &
            point_t(l, [length, 0.0_qp]), point_t(first + 1, pivot + arm(:, k))]
      end do
      call join_parallelogram(d, bars)
      if (chance(d%dice, 0.5_wp)) then
         call add_drive(d, drive_angle, first, 0, way)
      else
         call add_drive(d, drive_relangle, base, first, way)
      end if
      d%group%redundant = bars > 2
      if (.not. branches) return
      call set_steady(d, way)
      d%group%branch_after = double(d%from + (d%to - d%from)*number(d, 0.0_qp, 0.6_qp))
   end subroutine add_parallelogram

   !> The links from `first` on to where the parallelogram has them, its bars at 0.4 to 1.1 rad from its base lines.
   subroutine lay_parallelogram(d, base, first, bars, pivot, arm, length)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: base, first, bars
      real(qp), intent(in) :: pivot(2), arm(2, bars), length
      real(qp) :: phi, o(2), r(2)
      integer :: k, l

      associate (b => d%b(base))
         phi = b%phi%v + atan2(arm(2, 2), arm(1, 2)) + sign(number(d, 0.4_qp, 1.1_qp), number(d, -1.0_qp, 1.0_qp))
         r = length*[cos(phi), sin(phi)]
         do k = 0, bars
            l = first + merge(1, merge(0, k, k == 1), k == 0)
            o = 0.0_qp
            if (k > 0) o = pivot + arm(:, k)
            o = [b%x%v + o(1)*b%c%v - o(2)*b%s%v, b%y%v + o(1)*b%s%v + o(2)*b%c%v]
            if (k == 0) o = o + r
            d%s%links(l)%at = [o, merge(b%phi%v, phi, k == 0)]
            d%b(l)%x%v = o(1)
            d%b(l)%y%v = o(2)
            d%b(l)%phi%v = d%s%links(l)%at(3)
         end do
         call set_trigonometry(d%b(first:first + bars))
      end associate
   end subroutine lay_parallelogram

   !> Pairs: base and bar 1, bar 1 and coupler, coupler and bar 2, bar 2 and base, and two for each further bar.
   subroutine join_parallelogram(d, bars)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: bars
      integer :: k, p

      do k = 1, bars
         p = size(d%s%points) - 4*(bars - k + 1)
         if (k == 1) call join_points(d, p + 1, p + 2)
         call join_points(d, p + 3, p + 4)
         if (k > 1) call join_points(d, p + 2, p + 1)
      end do
   end subroutine join_parallelogram

   subroutine join_points(d, i, j)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: i, j
      type(pair_t) :: pair

      pair%point_i = merge(i, j, chance(d%dice, 0.5_wp))
      pair%point_j = i + j - pair%point_i
      d%s%pairs = [d%s%pairs, pair]
   end subroutine join_points
end module scheme_groups
