!> The components of a mechanism whose groups share nothing but the link that the free drive places, as dyads on one
!> crank do: that link with those of one group, or of several in a row. Each is a mechanism of its own.
module circuit_components
   use kinds, only: wp
   use planar, only: pi
   use mechanism, only: mechanism_t, pair_revolute, pair_prismatic, drive_angle, drive_slide, pair_links, drive_links
   use independent, only: part_t, part_of_links, mechanism_of
   use curve_equations, only: is_redundant
   use circuit_curve, only: curve_point_t
   use circuit_trace, only: end_closed
   use circuit_branches, only: circuits_t, find_level, turns_of
   implicit none
   private
   public :: component_t, circuit_position_t, split, make_regular, positions_at, find_position, &
      value_of_assembly, same_value

   !> Values of the drive that differ by less are one, in rad and lengths.
   real(wp), parameter :: same_value = 64.0_wp*sqrt(epsilon(1.0_wp))

   !> One component: a mechanism of its own, and its branches. Values of the drive are in rad or in
   !> the lengths of the whole mechanism's curve, and with the turns that they have on the circuit.
   type :: component_t
      type(part_t) :: part
      type(mechanism_t) :: m
      integer :: drive = 0                       !< the number of the free one
      type(circuits_t) :: found
      real(wp) :: unit = 1.0_wp                  !< of the drive's value on its curve
      real(wp), allocatable :: ends(:, :)        !< (2, branches) the least and greatest value of the drive
      real(wp), allocatable :: period(:)         !< (branches) after which it closes without dead points; otherwise 0
      integer, allocatable :: next(:, :)         !< (2, branches) the branch beyond the dead point there; 0: none
   end type component_t

   !> A position: of each component its branch, and the value of the drive there.
   type :: circuit_position_t
      integer, allocatable :: branch(:)
      real(wp), allocatable :: value(:)
   end type circuit_position_t

contains

   !> The `components` of `m` with the free drive number `drive`; none where there are fewer than two: the drive must
   !> place a link by itself, which is joined to the ground by one pair.
   subroutine split(m, drive, components)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: drive
      type(component_t), allocatable, intent(out) :: components(:)
      type(mechanism_t) :: g
      integer :: of_link(size(m%links)), of_pair(size(m%pairs)), of_drive(size(m%drives)), driven, n, i, c

      allocate (components(0))
      driven = driven_link(m, drive)
      if (driven == 0) return
      g = m
      g%links(driven)%ground = .true.
      of_link = part_of_links(g)
      n = maxval(of_link)
      of_pair = [(maxval(of_link(pair_links(m, m%pairs(i)))), i=1, size(m%pairs))]
      of_drive = [(maxval(of_link(drive_links(m, m%drives(i)))), i=1, size(m%drives))]
      if (n < 2 .or. count(of_pair == 0) /= 1 .or. count(of_drive == 0) /= 1) return
      deallocate (components)
      allocate (components(n))
      do c = 1, n
         associate (one => components(c), part => components(c)%part)
            part%links = pack([(i, i=1, size(m%links))], of_link == c .or. of_link == 0)
            part%pairs = pack([(i, i=1, size(m%pairs))], of_pair == c .or. of_pair == 0)
            part%drives = pack([(i, i=1, size(m%drives))], of_drive == c .or. of_drive == 0)
            part%points = pack([(i, i=1, size(m%points))], of_link(m%points%link) == c .or. &
               [(any(m%pairs(part%pairs)%point_i == i .or. m%pairs(part%pairs)%point_j == i), i=1, size(m%points))])
            allocate (part%requests(0), part%branch_requests(0))
            g = m
            if (allocated(g%tolerances)) deallocate (g%tolerances)
            one%m = mechanism_of(g, part)
            one%drive = findloc(part%drives, drive, dim=1)
            if (2*size(part%pairs) + size(part%drives) /= 3*count(.not. one%m%links%ground)) then
               deallocate (components)
               allocate (components(0))
               return
            end if
         end associate
      end do
   end subroutine split

   !> The link of `m` that drive number `drive` places by itself; 0: none.
   pure integer function driven_link(m, drive) result(link)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: drive
      integer :: links(2), i, n

      link = 0
      associate (d => m%drives(drive))
         if (d%kind == drive_angle) link = d%subject
         if (d%kind == drive_slide) then
            links = pair_links(m, m%pairs(d%subject))
            if (any(m%links(links)%ground)) link = sum(links, mask=.not. m%links(links)%ground)
         end if
         n = 0
         do i = 1, size(m%pairs)
            links = pair_links(m, m%pairs(i))
            if (link == 0 .or. all(links /= link) .or. .not. any(m%links(links)%ground)) cycle
            n = n + 1
            if (m%pairs(i)%kind /= merge(pair_revolute, pair_prismatic, d%kind == drive_angle)) n = 2
         end do
      end associate
      if (n /= 1) link = 0
   end function driven_link

   !> Makes the branches of component `c` ready; `length`: of the whole mechanism's curve. `is_regular`: its circuits
   !> are all known, none has a change point or rests, and none has a dead point at the first instant.
   subroutine make_regular(c, length, is_regular)
      type(component_t), intent(inout) :: c
      real(wp), intent(in) :: length
      logical, intent(out) :: is_regular
      integer :: b, side, other, k

      if (.not. c%found%curve%is_angle) c%unit = c%found%curve%closure%length/length

      associate (found => c%found)
         is_regular = .not. (found%is_held .or. found%are_more .or. is_redundant(found%curve) &
            .or. size(found%meetings) > 0 .or. any(found%list%rests))
         if (.not. is_regular) return
         associate (n => size(found%branches))
            allocate (c%ends(2, n), c%period(n), c%next(2, n))
         end associate
         do b = 1, size(found%branches)
            associate (branch => found%branches(b), circuit => found%list(found%branches(b)%circuit))
               c%ends(:, b) = [value_of(circuit%points(branch%first)), value_of(circuit%points(branch%last))]
               c%ends(:, b) = [minval(c%ends(:, b)), maxval(c%ends(:, b))]
               c%period(b) = 0.0_wp
               if (all(circuit%ends == end_closed) .and. all(branch%dead == 0)) &
                  c%period(b) = 2.0_wp*pi*turns_of(circuit)
               is_regular = is_regular .and. branch%sign /= 0
               do side = 1, 2
                  c%next(side, b) = 0
                  if (branch%dead(side) == 0) cycle
                  do other = 1, size(found%branches)
                     if (other /= b .and. found%branches(other)%dead(side) == branch%dead(side)) c%next(side, b) = other
                  end do
                  is_regular = is_regular .and. c%next(side, b) > 0
                  do k = 1, size(found%assemblies)
                     if (found%assemblies(k)%branch == b) is_regular = is_regular .and. &
                        abs(value_of_assembly(c, k) - c%ends(side, b)) > same_value
                  end do
               end do
            end associate
         end do
      end associate

   contains

      !> The drive's value at `p`.
      pure real(wp) function value_of(p)
         type(curve_point_t), intent(in) :: p

         value_of = c%unit*p%value(0)
      end function value_of
   end subroutine make_regular

   !> The positions of component `c` at the `value` of the drive; `turns`: whole turns of that do not count.
   function positions_at(c, value, turns) result(s)
      type(component_t), intent(in) :: c
      real(wp), intent(in) :: value
      logical, intent(in) :: turns
      type(circuit_position_t) :: s
      real(wp) :: x
      integer :: b

      allocate (s%branch(0), s%value(0))
      do b = 1, size(c%period)
         x = value
         if (turns) x = value + 2.0_wp*pi*ceiling((c%ends(1, b) - same_value - value)/(2.0_wp*pi))
         do while (x > c%ends(1, b) - same_value .and. x < c%ends(2, b) + same_value)
            if (c%period(b) > 0.0_wp .and. x > c%ends(2, b) - same_value) exit
            s%branch = [s%branch, b]
            s%value = [s%value, x]
            if (.not. turns) exit
            x = x + 2.0_wp*pi
         end do
      end do
   end function positions_at

   !> The position `q` (3, links), in the unit of its curve, of component `c` on branch `b` at the `value` of the drive.
   subroutine find_position(c, b, value, q)
      type(component_t), intent(inout) :: c
      integer, intent(in) :: b
      real(wp), intent(in) :: value
      real(wp), allocatable, intent(out) :: q(:, :)
      type(curve_point_t) :: p
      real(wp) :: level, off, nearest
      integer :: k
      logical :: ok

      level = value
      if (c%period(b) > 0.0_wp) level = c%ends(1, b) + modulo(value - c%ends(1, b), c%period(b))
      level = max(c%ends(1, b), min(c%ends(2, b), level))
      level = level/c%unit
      nearest = huge(nearest)
      associate (points => c%found%list(c%found%branches(b)%circuit)%points)
         do k = c%found%branches(b)%first, c%found%branches(b)%last - 1
            if ((points(k)%value(0) - level)*(points(k + 1)%value(0) - level) > 0.0_wp) then
               off = abs(points(k)%value(0) - level)
               if (off < nearest) q = points(k)%q
               nearest = min(nearest, off)
               cycle
            end if
            call find_level(c%found%curve, points(k), points(k + 1), level, p, ok)
            if (.not. ok) cycle
            q = p%q
            return
         end do
         if (.not. allocated(q)) q = points(c%found%branches(b)%last)%q
      end associate
   end subroutine find_position

   !> The drive's value at assembly number `k` of component `c`.
   pure real(wp) function value_of_assembly(c, k) result(value)
      type(component_t), intent(in) :: c
      integer, intent(in) :: k

      associate (found => c%found, one => c%found%assemblies(k))
         value = one%value - found%list(found%branches(one%branch)%circuit)%shift
         if (.not. found%curve%is_angle) value = one%value/found%curve%closure%length*c%unit
      end associate
   end function value_of_assembly
end module circuit_components
