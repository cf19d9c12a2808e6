!> The circuits of a mechanism whose groups share nothing but the link that the free drive places: dyads on one crank.
!>
!> Each of its components has circuits of its own, traced once. A position of the whole is one of each component at the
!> same value of the drive, and its circuits are the components of this product over the drive. Of the whole no equation
!> is solved: n dyads have 2**n positions, and 2 n curves.
module circuit_product
   use kinds, only: wp
   use system_calls, only: signal_received
   use planar, only: pi, without_turns
   use mechanism, only: mechanism_t, plane_origin
   use scales, only: characteristic_length
   use assemblies, only: assemblies_t
   use curve_equations, only: deck_position
   use circuit_curve, only: curve_point_t, start_point
   use circuit_trace, only: circuit_t, end_closed
   use circuit_branches, only: circuits_t, circuit_assembly_t, max_circuits, add_branches, number_assemblies
   use circuit_components, only: component_t, circuit_position_t, positions_at, find_position, &
      value_of_assembly, same_value
   use circuit_walk, only: leg_t, walk_t, walk, is_on
   implicit none
   private
   public :: multiply

   !> Positions that differ by no more, in rad and lengths, are one.
   real(wp), parameter :: same_place = 1.0e-5_wp
   !> So many positions at one value of the drive are gone through, and put in order.
   integer, parameter :: max_states = 20000, max_sorted = 1000
   !> Places count as off by no more, as card ASSEMBLY counts them.
   real(wp), parameter :: far_place = 0.25_wp
   !> Points of a leg to be drawn, and of all legs and components together.
   integer, parameter :: most_drawn = 96, least_drawn = 8, all_drawn = 200000

contains

   !> Adds to `found` the circuits of `m`, whose `components` are regular, with their branches, dead points and
   !> assemblies. The first is that of the position `start` (3, links), if that is known. Those of the assemblies
   !> `first` of the first instant follow, and those of the drive's `values`. `draws`: with points for a picture.
   !> `ok`: it can be done: two components that are at dead points together have a change point, which is not done here.
   subroutine multiply(m, components, first, start, values, draws, found, ok)
      type(mechanism_t), intent(in) :: m
      type(component_t), intent(inout) :: components(:)
      type(assemblies_t), intent(in) :: first
      real(wp), intent(in) :: start(:, :), values(:)
      logical, intent(in) :: draws
      type(circuits_t), intent(inout) :: found
      logical, intent(out) :: ok
      type(walk_t), allocatable :: walks(:)
      integer :: n_walks, legs, k

      ok = .true.
      n_walks = 0
      allocate (walks(64))
      if (size(start) > 0) call add_through(start)
      do k = 1, size(first%list)
         call add_through(first%list(k)%position)
      end do
      call add_at(found%curve%first, .false.)
      do k = 1, size(values)
         call add_at(values(k), .true.)
      end do
      call add_between()
      if (.not. ok) return
      legs = sum([(size(walks(k)%legs), k=1, n_walks)])
      do k = 1, n_walks
         call add_circuit(walks(k))
      end do
      call set_signs()

   contains

      !> Adds the circuit through the `position` (3, links) of the first instant.
      subroutine add_through(position)
         real(wp), intent(in) :: position(:, :)
         type(circuit_position_t) :: s
         integer :: c, a, nearest
         real(wp) :: least, away

         allocate (s%branch(size(components)), s%value(size(components)))
         do c = 1, size(components)
            nearest = 0
            least = same_place
            associate (found_c => components(c)%found)
               do a = 1, size(found_c%assemblies)
                  away = distance_of(found_c, found_c%assemblies(a)%q, position(:, components(c)%part%links))
                  if (away > least) cycle
                  least = away
                  nearest = a
               end do
               if (nearest == 0) return
               s%branch(c) = found_c%assemblies(nearest)%branch
               s%value(c) = value_of_assembly(components(c), nearest)
            end associate
         end do
         call add(s)
      end subroutine add_through

      !> How far the position `q`, in the unit of the curve, is from `position` in the deck's, but for whole turns.
      pure real(wp) function distance_of(found_c, q, position) result(away)
         type(circuits_t), intent(in) :: found_c
         real(wp), intent(in) :: q(:, :), position(:, :)
         real(wp) :: off(3, size(q, 2))

         off = q - position
         off(:2, :) = q(:2, :) - position(:2, :)/found_c%curve%closure%length
         off(3, :) = without_turns(off(3, :))
         away = maxval(abs(off))
      end function distance_of

      !> Adds the circuit through `s`, unless it is known.
      subroutine add(s)
         type(circuit_position_t), intent(in) :: s
         type(walk_t), allocatable :: more(:)
         integer :: i

         if (.not. ok .or. found%are_more .or. signal_received() > 0) return
         do i = 1, n_walks
            if (is_on(components, walks(i), s)) return
         end do
         if (n_walks == max_circuits) then
            found%are_more = .true.
            return
         end if
         if (n_walks == size(walks)) then
            allocate (more(2*n_walks))
            more(:n_walks) = walks
            call move_alloc(more, walks)
         end if
         n_walks = n_walks + 1
         call walk(components, s, walks(n_walks), ok)
      end subroutine add

      !> Adds the circuits through all positions at the `value` of the drive; `sorted`: in the order of card ASSEMBLY.
      subroutine add_at(value, sorted)
         real(wp), intent(in) :: value
         logical, intent(in) :: sorted
         type(circuit_position_t) :: options(size(components)), s
         real(wp), allocatable :: away(:)
         integer, allocatable :: order(:)
         integer :: sizes(size(components)), all_of_them, c, i, j, rest

         all_of_them = 1
         do c = 1, size(components)
            options(c) = positions_at(components(c), value, found%curve%is_angle)
            sizes(c) = size(options(c)%branch)
            if (all_of_them > max_states/max(1, sizes(c))) then
               ! So many positions lie on more circuits than are counted, or nearly.
               found%is_complete = .false.
               all_of_them = max_states
            else
               all_of_them = all_of_them*sizes(c)
            end if
         end do
         if (all_of_them == 0) return
         order = [(i, i=0, all_of_them - 1)]
         if (sorted .and. all_of_them <= max_sorted) then
            away = distances(options, sizes, all_of_them)
            do i = 2, size(order)
               do j = i, 2, -1
                  if (away(order(j - 1) + 1) <= away(order(j) + 1)) exit
                  order([j - 1, j]) = order([j, j - 1])
               end do
            end do
         end if
         allocate (s%branch(size(components)), s%value(size(components)))
         do i = 1, size(order)
            if (.not. ok .or. found%are_more .or. signal_received() > 0) return
            rest = order(i)
            do c = size(components), 1, -1
               associate (k => 1 + modulo(rest, sizes(c)))
                  s%branch(c) = options(c)%branch(k)
                  s%value(c) = options(c)%value(k)
               end associate
               rest = rest/sizes(c)
            end do
            call add(s)
         end do
      end subroutine add_at

      !> Squares of how far all combinations of `options` are from the deck's estimate, as card ASSEMBLY measures it.
      function distances(options, sizes, all_of_them) result(away)
         type(circuit_position_t), intent(in) :: options(:)
         integer, intent(in) :: sizes(:), all_of_them
         real(wp) :: away(all_of_them)
         real(wp), allocatable :: own(:), q(:, :)
         integer :: c, k, i, before

         away = 0.0_wp
         before = 1
         do c = size(components), 1, -1
            allocate (own(sizes(c)), source=0.0_wp)
            do k = 1, sizes(c)
               call find_position(components(c), options(c)%branch(k), options(c)%value(k), q)
               q = deck_position(components(c)%found%curve, q)
               do i = 1, size(q, 2)
                  associate (estimate => components(c)%m%links(i)%position)
                     q(:2, i) = (q(:2, i) + plane_origin(m) - estimate(:2))/characteristic_length(m)
                     own(k) = own(k) + min(sum(q(:2, i)**2), far_place**2) + without_turns(q(3, i) - estimate(3))**2
                  end associate
               end do
            end do
            away = away + [(own(1 + modulo(i/before, sizes(c))), i=0, all_of_them - 1)]
            before = before*sizes(c)
            deallocate (own)
         end do
      end function distances

      !> Adds the circuits through all positions between neighbouring ends of branches.
      subroutine add_between()
         real(wp), allocatable :: values(:)
         integer :: c, b, i, j

         allocate (values(0))
         do c = 1, size(components)
            do b = 1, size(components(c)%period)
               if (components(c)%period(b) > 0.0_wp) cycle
               values = [values, components(c)%ends(:, b)]
            end do
         end do
         if (found%curve%is_angle) values = modulo(values, 2.0_wp*pi)
         do i = 2, size(values)
            do j = i, 2, -1
               if (values(j - 1) <= values(j)) exit
               values([j - 1, j]) = values([j, j - 1])
            end do
         end do
         if (found%curve%is_angle .and. size(values) > 0) values = [values, values(1) + 2.0_wp*pi]
         do i = 2, size(values)
            if (values(i) - values(i - 1) > same_value) call add_at(0.5_wp*(values(i - 1) + values(i)), .false.)
         end do
      end subroutine add_between

      !> Adds `one` as a circuit with its branches, dead points and assemblies.
      subroutine add_circuit(one)
         type(walk_t), intent(in) :: one
         type(circuit_t), allocatable :: more(:)
         integer :: i, l, side, d, before, b
         logical :: closes

         i = size(found%list) + 1
         allocate (more(i))
         more(:i - 1) = found%list
         more(i)%ends = one%ends
         allocate (more(i)%changes(0))
         call put_points(one, more(i))
         call move_alloc(more, found%list)
         d = size(found%dead)
         before = size(found%branches)
         call add_branches(found, i)
         closes = all(one%ends == end_closed)
         do l = 1, size(one%legs)
            if (all(one%legs(l)%by == 0)) cycle
            ! The dead point at its beginning, and of an open circuit none at the first.
            side = merge(1, 2, one%legs(l)%way > 0)
            if (.not. closes .and. l == 1) cycle
            d = d + 1
            call name_dead_point(one%legs(l), side, d)
         end do
         do b = before + 1, size(found%branches)
            call add_assemblies(one%legs(b - before), b)
         end do
      end subroutine add_circuit

      !> Gives dead point number `d` the links of that of the component that ends `leg` on this `side`.
      subroutine name_dead_point(leg, side, d)
         type(leg_t), intent(in) :: leg
         integer, intent(in) :: side, d
         integer :: i

         associate (c => components(leg%by(side)), limit => found%dead(d)%limit)
            associate (own => c%found%dead(c%found%branches(leg%low%branch(leg%by(side)))%dead(side))%limit)
               do i = 1, size(own%links)
                  if (own%links(i) > 0) limit%links(i) = c%part%links(own%links(i))
               end do
               limit%more = own%more
               limit%in_line = own%in_line
            end associate
         end associate
      end subroutine name_dead_point

      !> Gives `circuit` its points: the ends of legs and one or, to be drawn, several between.
      subroutine put_points(one, circuit)
         type(walk_t), intent(in) :: one
         type(circuit_t), intent(inout) :: circuit
         real(wp) :: begin, along
         integer :: l, k, n, inside

         inside = 1
         if (draws) inside = max(least_drawn, min(most_drawn, all_drawn/(legs*size(components))))
         allocate (circuit%points(1 + size(one%legs)*(inside + 1)))
         begin = 0.0_wp
         n = 1
         do l = 1, size(one%legs)
            associate (leg => one%legs(l))
               if (l == 1) then
                  begin = leg%low%value(1)
                  if (leg%way < 0) begin = begin + leg%length
                  call put_point(leg, begin, 0.0_wp, circuit%points(1))
                  circuit%points(1)%is_dead = is_dead(leg, merge(1, 2, leg%way > 0))
               end if
               do k = 1, inside + 1
                  n = n + 1
                  along = 0.5_wp*(1.0_wp - cos(pi*k/(inside + 1)))
                  call put_point(leg, begin, along, circuit%points(n))
               end do
               circuit%points(n)%is_dead = is_dead(leg, merge(2, 1, leg%way > 0))
               begin = begin + leg%way*leg%length
            end associate
         end do
      end subroutine put_points

      !> The point `p` on `leg`, `along` from 0 to 1 in the sense of the circuit; the leg begins at the value `begin`.
      subroutine put_point(leg, begin, along, p)
         type(leg_t), intent(in) :: leg
         real(wp), intent(in) :: begin, along
         type(curve_point_t), intent(inout) :: p

         p%value = [begin + leg%way*along*leg%length, real(leg%way, wp), 0.0_wp]
         p%sign = leg%way*sign_of(leg)
         if (draws) call find_positions(leg%low, leg%length*merge(along, 1.0_wp - along, leg%way > 0), p%q)
      end subroutine put_point

      !> A component has a dead point at the end of `leg` on this `side`.
      pure logical function is_dead(leg, side)
         type(leg_t), intent(in) :: leg
         integer, intent(in) :: side

         is_dead = leg%by(side) > 0
         if (is_dead) is_dead = components(leg%by(side))%next(side, leg%low%branch(leg%by(side))) > 0
      end function is_dead

      !> The product of the components' signs on `leg`.
      pure integer function sign_of(leg)
         type(leg_t), intent(in) :: leg
         integer :: c

         sign_of = product([(components(c)%found%branches(leg%low%branch(c))%sign, c=1, size(components))])
      end function sign_of

      !> The position `q` (3, links) of all components, `further` than `low` by so much of the drive's value.
      subroutine find_positions(low, further, q)
         type(circuit_position_t), intent(in) :: low
         real(wp), intent(in) :: further
         real(wp), allocatable, intent(inout) :: q(:, :)
         real(wp), allocatable :: own(:, :)
         integer :: c

         if (.not. allocated(q)) allocate (q(3, size(m%links)))
         do c = 1, size(components)
            call find_position(components(c), low%branch(c), low%value(c) + further, own)
            own = deck_position(components(c)%found%curve, own)
            own(:2, :) = own(:2, :)/found%curve%closure%length
            q(:, components(c)%part%links) = own
         end do
      end subroutine find_positions

      !> Adds the assemblies of the first instant on `leg`, which is branch `b`, in the sense of its circuit.
      subroutine add_assemblies(leg, b)
         type(leg_t), intent(in) :: leg
         integer, intent(in) :: b
         type(circuit_assembly_t) :: one
         real(wp) :: further, level
         integer :: k, turns

         level = found%curve%first - leg%low%value(1)
         turns = 0
         if (found%curve%is_angle) then
            level = level - 2.0_wp*pi*floor(level/(2.0_wp*pi) + same_value)
            turns = floor((leg%length - level)/(2.0_wp*pi))
            ! The end of a closed circuit is its beginning.
            if (all(leg%by == 0) .and. level + 2.0_wp*pi*turns > leg%length - same_value) turns = turns - 1
         end if
         if (level < -same_value .or. level > leg%length + same_value) return
         do k = 0, turns
            further = level + 2.0_wp*pi*merge(k, turns - k, leg%way > 0)
            one%branch = b
            one%value = found%branches(b)%range(1) &
               + further*merge(1.0_wp, found%curve%closure%length, found%curve%is_angle)
            call find_positions(leg%low, further, one%q)
            found%assemblies = [found%assemblies, one]
         end do
      end subroutine add_assemblies

      !> Numbers the assemblies, and gives the branches their signs: without an assembly those of all equations.
      subroutine set_signs()
         type(curve_point_t) :: p
         real(wp), allocatable :: q(:, :)
         logical :: regular

         call number_assemblies(found, first%list)
         if (size(found%list) == 0 .or. any(found%assemblies%number <= size(first%list))) return
         associate (leg => walks(1)%legs(1))
            call find_positions(leg%low, 0.5_wp*leg%length, q)
            call start_point(found%curve, deck_position(found%curve, q), p, regular)
            if (regular .and. p%sign*nint(sign(1.0_wp, p%value(1))) /= found%branches(1)%sign) &
               found%branches%sign = -found%branches%sign
         end associate
      end subroutine set_signs
   end subroutine multiply

end module circuit_product
