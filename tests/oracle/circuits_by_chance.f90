!> Circuits of mechanisms made by chance: four-bars and crank-sliders, one in four beside a change point, against Grashof's
!> condition and the law of cosines; six-bars against those of their dyads. circuits_by_chance COUNT [FIRST SEED]; the
!> last line is `N passed, N failed`.
program circuits_by_chance
   use kinds, only: wp
   use plane_vectors, only: pi, wrap_angle
   use mechanism, only: mechanism_t, link_t, point_t, pair_t, request_t, request_link, pair_revolute
   use set_analysis, only: set_analysis_t, make_set_analysis, advance_set
   use circuit_trace, only: end_closed
   use assemblies, only: assemblies_t, find_assemblies
   use circuits, only: circuits_t, revolutions_of, find_circuits
   use sample_mechanisms, only: four_bar, crank_slider, angle_drive
   use dyad_circuits, only: six_bar_t, branches_t, find_branches, positions, is_assembled
   use dice, only: dice_t, new_dice, between, chance, throw
   use test_counter, only: count_seeds
   implicit none

   !> A limit is known to so much in rad; circuits as wide as the distance of two values of the drive are found.
   real(wp), parameter :: known = 1.0e-8_wp, found_always = 5.0_wp*pi/180.0_wp, &
      too_narrow = 0.25_wp*pi/180.0_wp
   real(wp), parameter :: turn = 2.0_wp*pi
   call count_seeds(agrees, 300)

contains

   !> Whether the circuits of the mechanism of `seed` are those of its closed form.
   logical function agrees(seed)
      integer, intent(in) :: seed
      type(dice_t) :: d
      type(mechanism_t) :: m
      real(wp), allocatable :: ranges(:, :)

      d = new_dice(seed)
      if (chance(d, 0.3_wp)) then
         agrees = six_bar_agrees(d)
         return
      end if
      do
         if (chance(d, 0.5_wp)) then
            call throw_four_bar(d, m, ranges)
         else
            call throw_crank_slider(d, m, ranges)
         end if
         if (size(ranges, 2) > 0) exit
      end do
      agrees = compared(m, ranges)
   end function agrees

   !> A four-bar and the `ranges` (2, circuits) of its crank: the square of the diagonal is a**2 + d**2 - 2 a d cos phi,
   !> and lies between those of the difference and of the sum of coupler and rocker.
   subroutine throw_four_bar(d, m, ranges)
      type(dice_t), intent(inout) :: d
      type(mechanism_t), intent(out) :: m
      real(wp), allocatable, intent(out) :: ranges(:, :)
      real(wp) :: l(4), low, high, phi, diagonal, base, alpha
      integer :: i, k

      do i = 1, 4
         l(i) = between(d, 0.3_wp, 2.0_wp)
      end do
      if (chance(d, 0.25_wp)) then
         ! The longest with the shortest is almost as long as the other two.
         i = maxloc(l, dim=1)
         k = minloc(l, dim=1)
         l(i) = sum(l) - l(i) - 2.0_wp*l(k) + merge(1.0_wp, -1.0_wp, chance(d, 0.5_wp))*10.0_wp**(-throw(d, 8) - 1)
         if (l(i) < maxval(l)) l(i) = 0.0_wp
      end if
      allocate (ranges(2, 0))
      if (minval(l) <= 0.0_wp) return
      low = (l(1)**2 + l(4)**2 - (l(2) + l(3))**2)/(2.0_wp*l(1)*l(4))
      high = (l(1)**2 + l(4)**2 - (l(2) - l(3))**2)/(2.0_wp*l(1)*l(4))
      if (low >= 1.0_wp .or. high <= -1.0_wp) return
      if (low <= -1.0_wp .and. high >= 1.0_wp) then
         ranges = reshape([0.0_wp, turn, 0.0_wp, turn], [2, 2])
      else if (high >= 1.0_wp) then
         ranges = reshape([-acos(low), acos(low)], [2, 1])
      else if (low <= -1.0_wp) then
         ranges = reshape([acos(high), turn - acos(high)], [2, 1])
      else
         ranges = reshape([acos(high), acos(low), -acos(low), -acos(high)], [2, 2])
      end if
      m = four_bar()
      phi = between(d, ranges(1, 1), ranges(2, 1))
      m%points(2)%offset(1) = l(4)
      m%points(4)%offset(1) = l(1)
      m%points(6)%offset(1) = l(2)
      m%points(8)%offset(1) = l(3)
      m%drives(1)%polynomial(1) = phi
      diagonal = sqrt(l(1)**2 + l(4)**2 - 2.0_wp*l(1)*l(4)*cos(phi))
      base = atan2(-l(1)*sin(phi), l(4) - l(1)*cos(phi))
      alpha = base + acos(max(-1.0_wp, min(1.0_wp, (diagonal**2 + l(2)**2 - l(3)**2)/(2.0_wp*diagonal*l(2)))))
      m%links(2)%position(3) = phi
      m%links(3)%position = [l(1)*cos(phi), l(1)*sin(phi), alpha]
      m%links(4)%position = [l(4), 0.0_wp, atan2(l(1)*sin(phi) + l(2)*sin(alpha), &
         l(1)*cos(phi) + l(2)*cos(alpha) - l(4))]
   end subroutine throw_four_bar

   !> A crank of 1, a rod and a piston on the line y = h, and the `ranges` (2, circuits) of the crank: sin phi is off h
   !> by the rod at most.
   subroutine throw_crank_slider(d, m, ranges)
      type(dice_t), intent(inout) :: d
      type(mechanism_t), intent(out) :: m
      real(wp), allocatable, intent(out) :: ranges(:, :)
      real(wp) :: rod, h, low, high, phi

      rod = between(d, 0.3_wp, 2.0_wp)
      h = between(d, -1.0_wp, 1.0_wp)
      if (chance(d, 0.25_wp)) rod = 1.0_wp + abs(h)*merge(1.0_wp, -1.0_wp, chance(d, 0.5_wp)) &
         + merge(1.0_wp, -1.0_wp, chance(d, 0.5_wp))*10.0_wp**(-throw(d, 8) - 1)
      allocate (ranges(2, 0))
      if (rod < 0.1_wp) return
      low = h - rod
      high = h + rod
      if (low >= 1.0_wp .or. high <= -1.0_wp) return
      if (low <= -1.0_wp .and. high >= 1.0_wp) then
         ranges = reshape([0.0_wp, turn, 0.0_wp, turn], [2, 2])
      else if (high >= 1.0_wp) then
         ranges = reshape([asin(low), pi - asin(low)], [2, 1])
      else if (low <= -1.0_wp) then
         ranges = reshape([-pi - asin(high), asin(high)], [2, 1])
      else
         ranges = reshape([asin(low), asin(high), pi - asin(high), pi - asin(low)], [2, 2])
      end if
      m = crank_slider(h)
      phi = between(d, ranges(1, 1), ranges(2, 1))
      m%points(6)%offset(1) = rod
      m%drives(1)%polynomial(1) = phi
      m%links(2)%position(3) = phi
      m%links(3)%position = [cos(phi), sin(phi), asin(max(-1.0_wp, min(1.0_wp, (h - sin(phi))/rod)))]
      m%links(4)%position = [cos(phi) + rod*cos(m%links(3)%position(3)), h, 0.0_wp]
   end subroutine throw_crank_slider

   !> Whether a six-bar has the branches of its dyads, on as many circuits. Its circuits are wide, and so are its
   !> branches, which the angles of `dyad_circuits` do not miss then.
   logical function six_bar_agrees(d) result(ok)
      type(dice_t), intent(inout) :: d
      type(six_bar_t) :: b
      type(mechanism_t) :: m
      type(branches_t) :: expected
      type(assemblies_t) :: first
      type(circuits_t) :: found
      type(set_analysis_t) :: s
      real(wp) :: phi
      integer :: choice, i, k
      logical, allocatable :: taken(:)

      do
         call throw_six_bar(d, b)
         expected = find_branches(b)
         if (size(expected%circuit) == 0) cycle
         if (any(expected%range(2, :) - expected%range(1, :) < found_always)) cycle
         phi = between(d, expected%range(1, 1), expected%range(2, 1))
         choice = merge(1, 2, is_assembled(b, phi, 1))
         if (is_assembled(b, phi, choice)) exit
      end do
      m = mechanism_of(b, phi, choice)
      call make_set_analysis(m, s)
      call advance_set(s, 0.0_wp)
      call find_assemblies(m, s%now%motions(1)%t, first)
      call find_circuits(m, s%now%motions(1), 1, first, found)
      ok = .true.
      ! Between two of the oracle's angles.
      if (any([(found%branches(i)%range(2) - found%branches(i)%range(1) < too_narrow, i=1, size(found%branches))])) return
      ok = found%is_complete .and. size(found%branches) == size(expected%circuit) &
         .and. size(found%list) == count([(all(expected%circuit(:k - 1) /= expected%circuit(k)), k=1, size(expected%circuit))])
      allocate (taken(size(expected%circuit)), source=.false.)
      do i = 1, size(found%branches)
         do k = 1, size(taken)
            if (taken(k)) cycle
            taken(k) = is_branch(found%branches(i)%range, expected%range(:, k))
            if (taken(k)) exit
         end do
      end do
      ok = ok .and. all(taken) .and. size(found%list) == circuits_from_output(m, s)
   end function six_bar_agrees

   !> The number of circuits of the six-bar `m`, analysed by `s`, where its output is driven instead of the crank: the
   !> circuits are the same, whichever link is driven.
   integer function circuits_from_output(m, s) result(n)
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(in) :: s
      type(mechanism_t) :: other
      type(assemblies_t) :: first
      type(circuits_t) :: found

      other = m
      other%drives = [angle_drive(6, s%now%motions(1)%position(3, 6), 1.0_wp, 0.0_wp)]
      call find_assemblies(other, s%now%motions(1)%t, first)
      call find_circuits(other, s%now%motions(1), 1, first, found)
      n = size(found%list)
   end function circuits_from_output

   !> Whether two ranges of the drive are one; of a full turn, whether both are.
   pure logical function is_branch(a, b)
      real(wp), intent(in) :: a(2), b(2)

      is_branch = abs((a(2) - a(1)) - (b(2) - b(1))) <= known
      if (b(2) - b(1) < turn - known) is_branch = is_branch .and. all(abs(wrap_angle(a - b)) <= known)
   end function is_branch

   !> A six-bar of the kind that chance takes.
   subroutine throw_six_bar(d, b)
      type(dice_t), intent(inout) :: d
      type(six_bar_t), intent(out) :: b

      b%watt = chance(d, 0.5_wp)
      b%crank = between(d, 0.3_wp, 2.0_wp)
      b%coupler = between(d, 0.8_wp, 3.0_wp)
      b%rocker = between(d, 0.8_wp, 3.0_wp)
      b%base = between(d, 0.8_wp, 3.0_wp)
      b%arm = between(d, 0.3_wp, 2.0_wp)
      b%direction = between(d, -pi, pi)
      b%rod = between(d, 0.8_wp, 3.0_wp)
      b%output = between(d, 0.8_wp, 3.0_wp)
      b%pivot = [between(d, -3.0_wp, 4.0_wp), between(d, -3.0_wp, 3.0_wp)]
   end subroutine throw_six_bar

   !> The six-bar `b` at the crank angle `phi`, with the `choice` of its first dyad.
   function mechanism_of(b, phi, choice) result(m)
      type(six_bar_t), intent(in) :: b
      real(wp), intent(in) :: phi
      integer, intent(in) :: choice
      type(mechanism_t) :: m
      real(wp) :: p(2, 4), room(2)
      integer :: i

      call positions(b, phi, choice, 1, p, room)
      m%links = [link_t('BASE', .true.), link_t('CRANK', position=[0.0_wp, 0.0_wp, phi]), &
         link_t('COUPLER', position=[p(:, 1), direction(p(:, 1), p(:, 2))]), &
         link_t('ROCKER', position=[b%base, 0.0_wp, direction([b%base, 0.0_wp], p(:, 2))]), &
         link_t('ROD', position=[p(:, 3), direction(p(:, 3), p(:, 4))]), &
         link_t('OUTPUT', position=[b%pivot, direction(b%pivot, p(:, 4))])]
      m%points = [point_t('A0', 1), point_t('B0', 1, [b%base, 0.0_wp]), point_t('D0', 1, b%pivot), point_t('CR-0', 2), &
         point_t('CR-A', 2, [b%crank, 0.0_wp]), point_t('CO-A', 3), point_t('CO-B', 3, [b%coupler, 0.0_wp]), &
         point_t('RO-0', 4), point_t('RO-B', 4, [b%rocker, 0.0_wp]), &
         point_t('ARM', merge(4, 3, b%watt), b%arm*[cos(b%direction), sin(b%direction)]), point_t('ROD-C', 5), &
         point_t('ROD-D', 5, [b%rod, 0.0_wp]), point_t('OUT-0', 6), point_t('OUT-D', 6, [b%output, 0.0_wp])]
      m%pairs = [pair_t(pair_revolute, 'PA0', 1, 4), pair_t(pair_revolute, 'PA', 5, 6), pair_t(pair_revolute, 'PB', 7, 9), &
         pair_t(pair_revolute, 'PB0', 2, 8), pair_t(pair_revolute, 'PC', 10, 11), pair_t(pair_revolute, 'PD', 12, 14), &
         pair_t(pair_revolute, 'PD0', 3, 13)]
      m%drives = [angle_drive(2, phi, 1.0_wp, 0.0_wp)]
      m%requests = [(request_t(request_link, i), i=1, 6)]
      m%at = [0.0_wp]
   end function mechanism_of

   !> The direction from `a` to `b`.
   pure real(wp) function direction(a, b)
      real(wp), intent(in) :: a(2), b(2)

      direction = atan2(b(2) - a(2), b(1) - a(1))
   end function direction

   !> Whether `m` has circuits of these `ranges`: of a full turn one branch that closes after a turn, otherwise two with
   !> dead points at both ends; those that have no assembly at the first instant only if they are wide. The assemblies
   !> of the first instant are two.
   logical function compared(m, ranges)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: ranges(:, :)
      type(set_analysis_t) :: s
      type(assemblies_t) :: first
      type(circuits_t) :: found
      logical :: taken(size(ranges, 2))
      integer :: i, k

      call make_set_analysis(m, s)
      call advance_set(s, 0.0_wp)
      call find_assemblies(m, s%now%motions(1)%t, first)
      call find_circuits(m, s%now%motions(1), 1, first, found)
      taken = .false.
      compared = found%is_complete .and. sum([(size(found%branches(i)%assemblies), i=1, size(found%branches))]) == 2
      do i = 1, size(found%list)
         do k = 1, size(taken)
            if (taken(k)) cycle
            taken(k) = is_circuit(found, i, ranges(:, k))
            if (taken(k)) exit
         end do
         compared = compared .and. k <= size(taken)
      end do
      compared = compared .and. size(found%list) == count(taken) .and. taken(1) &
         .and. all(taken .or. ranges(2, :) - ranges(1, :) < found_always)
   end function compared

   !> Whether circuit number `i` has this `range` of the drive.
   logical function is_circuit(found, i, range)
      type(circuits_t), intent(in) :: found
      integer, intent(in) :: i
      real(wp), intent(in) :: range(2)
      integer, allocatable :: own(:)
      integer :: k

      own = pack([(k, k=1, size(found%branches))], found%branches%circuit == i)
      is_circuit = all(found%list(i)%ends == end_closed)
      if (range(2) - range(1) >= turn) then
         is_circuit = is_circuit .and. size(own) == 1 .and. revolutions_of(found%list(i)) == 1
         if (is_circuit) is_circuit = all(found%branches(own(1))%dead == 0)
         return
      end if
      is_circuit = is_circuit .and. size(own) == 2
      do k = 1, size(own)
         associate (b => found%branches(own(k)))
            is_circuit = is_circuit .and. all(b%dead > 0) .and. all(abs(wrap_angle(b%range - range)) <= known) &
               .and. abs((b%range(2) - b%range(1)) - (range(2) - range(1))) <= known
         end associate
      end do
   end function is_circuit
end program circuits_by_chance
