!> The first instant: the assembly that is nearest to the initial guess, by the distance that card ASSEMBLY prints.
!> Newton's method starts from the guess, block by block in solving order. Its assembly is kept if the bound of Newton
!> and Kantorovich leaves no other one as near. Otherwise a search goes through the positions of the blocks, depth first
!> and the nearest first. It leaves out what is further already than the nearest assembly so far.
!>
!> All blocks are assembled, also those that no table needs: what is printed chooses no assembly. If a block has no
!> position with any of the blocks below it, the others are assembled without it.
module initial_assembly
   use kinds, only: wp
   use plane_vectors, only: wrap_angle
   use cylinders, only: cylinder_length
   use convergence, only: convergence_t, nothing_gathered, is_solved, gather, ended_inconsistent, ended_elsewhere
   use motion, only: motion_t, new_motion
   use blocks, only: largest_known, blocks_below, own_unknowns
   use block_state, only: set_values, values_of, add_turns
   use block_solver, only: solve_block
   use link_motion, only: move_links
   use levenberg_marquardt, only: levenberg_marquardt_solve, find_closure_error
   use block_engine, only: block_engine_t, choice_t, solve_blocks, solve_each, separation_of
   use branch_switching, only: is_short_and_right
   use block_assemblies, only: block_positions_t, find_positions
   implicit none
   private
   public :: solve_first, solve_instant, measure_closure_error, places_of, squared_distances, is_nearer, alike

   !> More than any distance; its square is in range.
   real(wp), parameter :: unbounded = 0.5_wp*sqrt(huge(1.0_wp))

   !> Positions of one block, nearest to the guess first.
   type :: candidates_t
      real(wp), allocatable :: x(:, :)                  !< (unknowns of the block, positions)
      real(wp), allocatable :: distance(:)              !< (positions) see `squared_distances`
      real(wp) :: beyond = unbounded                    !< the distance of positions not looked for, at least
      logical :: are_all = .true.                       !< no nearer one can be missing
      integer :: chosen = 0                             !< the number of that in use; 0: none
      type(convergence_t) :: ending                     !< how the search for a position ended
   end type candidates_t

   !> All positions are enumerated of blocks of so many unknowns in each of both groups: eight in all, 70 paths.
   integer, parameter :: max_group = 4
   !> Places count as off by no more than this part of the characteristic length: a deck may give angles alone.
   real(wp), parameter :: far_place = 0.25_wp
   !> Positions that differ by less (rad, characteristic lengths) are one; of singular ones half of all digits is known.
   real(wp), parameter :: alike = max(1.0e-5_wp, 16.0_wp*sqrt(epsilon(1.0_wp))), singular_alike = sqrt(alike)
   !> Distances of which one is this part of the other or more are about equal.
   real(wp), parameter :: about_equal = 0.8_wp
   !> The largest number of blocks assembled.
   integer, parameter :: max_solves = 3000
   !> Distances that differ by less than this part are equal: rounding shall not choose.
   real(wp), parameter :: rounding = 64.0_wp*sqrt(epsilon(1.0_wp))

contains

   !> Solves for the motion at `t`, from the one accepted last (`follows`) or nearest to the initial guess.
   !> `convergence`: how it ended, with the largest change (rad, `length`) of a predicted value.
   subroutine solve_instant(e, t, follows, convergence)
      type(block_engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      logical, intent(in) :: follows
      type(convergence_t), intent(inout) :: convergence

      if (follows) then
         call solve_blocks(e, t, follows, convergence)
         if (e%state%excursion > 0.0_wp .and. is_solved(convergence)) convergence%is_certain = is_short_and_right(e, &
            convergence%change)
      else
         call solve_first(e, t, convergence)
      end if
   end subroutine solve_instant

   !> Solves for the first motion at `t`. `convergence`: how that ended.
   subroutine solve_first(e, t, convergence)
      type(block_engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      type(convergence_t), intent(out) :: convergence
      type(candidates_t), dimension(size(e%blocks%list)) :: found, by_deck
      type(convergence_t) :: rest
      real(wp) :: guess(3, size(e%estimate, 2)), turn(0:e%blocks%orientations), nearest
      logical :: is_complete, is_implied(size(guess, 2))
      integer :: places(2, size(guess, 2)), k, i

      call solve_blocks(e, t, .false., convergence)
      if (.not. e%blocks%solvable) return
      rest = nothing_gathered
      if (is_solved(convergence)) call solve_each(e, pack([(i, i=1, size(found))], &
         [(all(e%blocks%needed /= i), i=1, size(found))]), .false., rest)
      places = places_of(e)
      is_complete = is_solved(convergence) .and. is_solved(rest)
      if (is_complete) is_complete = without_length(e, [(i, i=1, size(e%cylinders))]) == 0

      ! Places may imply other angles than those of the deck: the links of a class turn with its first one.
      turn = 0.0_wp
      associate (class => e%blocks%tree%orientation, offset => e%geometry%equations%axes%angle_offset)
         do k = size(class), 1, -1
            if (class(k) > 0) turn(class(k)) = wrap_angle(e%estimated(class(k)) + offset(k) - e%estimate(3, k))
         end do
         is_implied = abs(turn(class)) > alike
         guess = e%estimate
         guess(3, :) = guess(3, :) + turn(class)
      end associate
      if (is_complete .and. .not. any(is_implied)) then
         if (is_alone(e, places, guess)) return
      end if

      e%choice = choice_t()
      nearest = unbounded
      if (any(is_implied)) call find_nearest(e, places, e%estimate, is_complete, by_deck, nearest)
      call find_nearest(e, places, guess, is_complete, found)
      do i = 1, size(found)
         associate (one => found(i), choice => e%choice(i))
            if (one%chosen == 0) cycle
            choice%is_incomplete = .not. one%are_all
            if (one%chosen == 1 .and. size(one%distance) > 1) &
               choice%is_close = one%distance(1) > about_equal*one%distance(2)
         end associate
      end do
      if (is_nearer(nearest, distance_of(e, places, e%estimate))) &
         e%choice(pack(places(1, :), is_implied))%is_incomplete = .true.
      convergence = nothing_gathered
      k = findloc(found(e%blocks%needed)%chosen, 0, dim=1)
      if (k == 0) then
         call solve_each(e, e%blocks%needed, .false., convergence)
      else
         call solve_each(e, e%blocks%needed(:k - 1), .false., convergence)
         if (is_solved(convergence)) call gather(found(e%blocks%needed(k))%ending, convergence)
      end if
   end subroutine solve_first

   !> Whether no other assembly can be about as near to `guess` as the one that `e` has: that is at the guess itself, or
   !> in the first block that differs an angle is off by the separation of its positions, at least.
   logical function is_alone(e, places, guess) result(is)
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: places(:, :)               !< (2, links) see `places_of`
      real(wp), intent(in) :: guess(:, :)               !< (3, links) x and y from the origin of the chain, rad
      real(wp) :: square(2, size(guess, 2)), behind
      integer :: i

      square = squares_of(e, guess)
      is = sqrt(sum(square)) <= alike
      if (is) return
      behind = 0.0_wp
      is = .true.
      do i = size(e%blocks%list), 1, -1
         behind = behind + sum(square, mask=places == i)
         if (.not. e%blocks%list(i)%direct) is = about_equal*(e%choice(i)%separation &
            - sqrt(sum(square(1, :), mask=places(1, :) == i))) >= sqrt(behind)
         if (.not. is) return
      end do
   end function is_alone

   !> Puts the assembly that is nearest to `guess` into the values of `e`; if there is none, the positions of the blocks
   !> that have one.
   subroutine find_nearest(e, places, guess, is_complete, found, distance)
      type(block_engine_t), intent(inout) :: e
      integer, intent(in) :: places(:, :)               !< (2, links) see `places_of`
      real(wp), intent(in) :: guess(:, :)               !< (3, links) x and y from the origin of the chain, rad
      logical, intent(in) :: is_complete                !< `e` has an assembly: further ones do not count
      type(candidates_t), intent(out) :: found(:)       !< (blocks) their positions
      real(wp), intent(out), optional :: distance       !< of the assembly; `unbounded`: there is none
      type(candidates_t) :: nearest(size(found))        !< with the nearest assembly so far
      real(wp) :: values(0:e%blocks%unknowns)           !< of the nearest assembly
      real(wp) :: limit                                 !< the distance from which on assemblies do not count
      real(wp) :: spent(0:size(found))                  !< the square of the distance of all blocks up to this one
      integer :: latest(size(found))                    !< the last block below that iterates; 0: none
      integer :: seen(size(found))                      !< the number of the choice after which its positions were found
      integer, dimension(0:e%blocks%unknowns) :: changed, open, last !< number of the choice; 1: not found; see `latest`
      logical :: is_given_up(size(found)), is_found     !< no other positions help it; an assembly is found
      integer, allocatable :: below(:)
      integer :: i, k, solves, choices

      values = e%state%u%value
      limit = unbounded
      if (is_complete) limit = distance_of(e, places, guess)
      if (is_complete) limit = limit + alike*max(1.0_wp, limit)
      last = 0
      do i = 1, size(found)
         associate (own => own_unknowns(e%blocks, i))
            latest(i) = largest_known(e%blocks, i, last)
            last(own) = merge(latest(i), i, e%blocks%list(i)%direct)
            call set_values(e%blocks, i, e%estimated(own), e%state)
            allocate (found(i)%x(size(own), 0), found(i)%distance(0))
         end associate
      end do
      is_given_up = .false.
      is_found = .false.
      open = 0
      changed = 0
      seen = -1
      spent = 0.0_wp
      choices = 0
      solves = 0
      i = 1
      do
         if (i > size(found)) then
            ! An assembly, or all that can be assembled.
            nearest = found
            values = e%state%u%value
            is_found = .true.
            if (any(found%chosen == 0)) exit
            limit = sqrt(spent(size(found)))
            i = last_promising([(k, k=1, size(found))])
            if (i == 0) exit
            found(i + 1:)%chosen = 0
         else
            associate (own => own_unknowns(e%blocks, i))
               open(own) = 0
               if (largest_known(e%blocks, i, open) == 0) then
                  if (found(i)%chosen == 0) call look_for_positions()
                  if (last_promising([i]) == i) then
                     found(i)%chosen = found(i)%chosen + 1
                     call set_values(e%blocks, i, found(i)%x(:, found(i)%chosen), e%state)
                     spent(i) = spent(i - 1) + found(i)%distance(found(i)%chosen)**2
                     choices = choices + 1
                     changed(own) = choices
                     i = i + 1
                     cycle
                  end if

                  ! Back to the last block that has another position, of those below where that alone helps.
                  below = [(k, k=1, i)]
                  if (size(found(i)%distance) == 0 .or. .not. limit < unbounded) below = blocks_below(e%blocks, i)
                  below = below(:size(below) - 1)
                  k = 0
                  if (solves < max_solves .and. .not. is_given_up(i)) k = last_promising(below)
                  if (k == 0 .and. limit < unbounded) exit
                  if (k > 0 .or. (.not. is_given_up(i) .and. any(found(below)%chosen > 1))) then
                     is_given_up(i) = k == 0
                     i = max(1, k)
                     found(merge(i + 1, 1, k > 0):)%chosen = 0
                     cycle
                  end if
               end if
               found(i)%chosen = 0
               spent(i) = spent(i - 1)
               open(own) = 1
               call set_values(e%blocks, i, e%estimated(own), e%state)
               i = i + 1
            end associate
         end if
      end do
      if (is_found) found = nearest
      if (.not. is_found) found%chosen = 1
      do i = 1, size(found)
         if (solves >= max_solves .and. size(found(i)%distance) > 1) found(i)%are_all = .false.
         call set_values(e%blocks, i, values(own_unknowns(e%blocks, i)), e%state)
      end do
      if (present(distance)) distance = merge(limit, unbounded, is_found .and. all(found%chosen > 0))

   contains

      !> Finds the positions of block `i`, unless those that are known still hold.
      subroutine look_for_positions()
         real(wp) :: budget

         budget = sqrt(max(0.0_wp, limit**2 - spent(i - 1)))
         if (largest_known(e%blocks, i, changed) <= seen(i) .and. about_equal*found(i)%beyond >= budget) return
         call find_candidates(e, i, places, guess, budget, found(i))
         seen(i) = choices
         solves = solves + 1
      end subroutine look_for_positions

      !> The last of the blocks of `list` that has another position, with which an assembly can be nearer than the
      !> limit; 0: none. Later blocks that build on none from this one on are as near as they were, at best.
      integer function last_promising(list) result(k)
         integer, intent(in) :: list(:)
         real(wp) :: square
         integer :: m, j

         do m = size(list), 1, -1
            k = list(m)
            if (found(k)%chosen >= size(found(k)%distance)) cycle
            square = spent(k - 1) + found(k)%distance(found(k)%chosen + 1)**2
            do j = k + 1, size(found)
               if (latest(j) >= k .or. largest_known(e%blocks, j, changed) > seen(j)) cycle
               if (size(found(j)%distance) > 0) square = square + min(found(j)%distance(1), found(j)%beyond)**2
            end do
            if (is_nearer(sqrt(square), limit)) return
         end do
         k = 0
      end function last_promising
   end subroutine find_nearest

   !> Finds the positions `found` of block `i`, for the values that `e` has of earlier blocks. Others than that of
   !> Newton's method are not looked for if all of them are further from `guess` than the distance `budget`. `places`,
   !> `guess`: see `find_nearest`. If there is no position, found%ending has the closure error that remains.
   subroutine find_candidates(e, i, places, guess, budget, found)
      type(block_engine_t), intent(inout) :: e
      integer, intent(in) :: i, places(:, :)
      real(wp), intent(in) :: guess(:, :), budget
      type(candidates_t), intent(out) :: found
      type(block_positions_t) :: every
      real(wp), dimension(e%blocks%list(i)%shape%n) :: start, least
      real(wp) :: angles
      integer, allocatable :: cylinders_here(:)
      integer :: k

      cylinders_here = pack([(k, k=1, size(e%cylinders))], last_places(e, places) == i)
      allocate (found%x(size(start), 0), found%distance(0))
      start = e%estimated(own_unknowns(e%blocks, i))
      call set_values(e%blocks, i, start, e%state)
      call solve_block(e%blocks, e%geometry, i, .true., e%work, e%state, found%ending)
      if (is_solved(found%ending)) call note_position(values_of(e%blocks, i, e%state), found%ending%singular)
      if (e%blocks%list(i)%direct) return
      if (size(found%distance) > 0) then
         found%beyond = separation_of(e%blocks, e%geometry, i, e%state, found%ending) - angles
         if (about_equal*found%beyond >= budget) return
         found%beyond = unbounded
      end if

      call find_positions(e%blocks, e%geometry, i, e%work, e%state, max_group, e%starts(i)%paths, every)
      do k = 1, size(every%sign_of)
         call note_position(every%x(:, k), every%sign_of(k) == 0)
      end do
      ! There is one more if that of Newton's method is none of them.
      found%are_all = .not. (every%moves .or. every%is_wide .or. every%failed > 0) &
         .and. size(found%distance) <= size(every%sign_of)
      if (found%are_all .and. size(found%distance) > 0) return
      call set_values(e%blocks, i, start, e%state)
      call levenberg_marquardt_solve(e%blocks, e%geometry, i, e%state)
      least = values_of(e%blocks, i, e%state)
      call solve_block(e%blocks, e%geometry, i, .true., e%work, e%state, found%ending)
      if (is_solved(found%ending)) then
         call note_position(values_of(e%blocks, i, e%state), found%ending%singular)
         if (size(found%distance) == 0) then
            found%ending%ended = ended_elsewhere
            found%ending%open%pair = without_length(e, cylinders_here)
         end if
      else
         call set_values(e%blocks, i, least, e%state)
         call find_closure_error(e%blocks, e%geometry, i, e%state, found%ending)
      end if

   contains

      !> Puts the position `unknowns` in its place among those found, unless it is there already. Its angles are brought
      !> within half a turn of the guess; drives between two angles then add whole turns. Of two that are as near, that
      !> with the greater first value: rounding shall not choose. A position with a cylinder whose length is not above 0
      !> is none.
      subroutine note_position(unknowns, is_singular)
         real(wp), intent(in) :: unknowns(:)
         logical, intent(in) :: is_singular
         real(wp) :: y(size(unknowns)), square(2, size(places, 2)), distance
         integer :: k, first

         associate (is_angle => own_unknowns(e%blocks, i) <= e%blocks%orientations)
            do k = 1, size(found%distance)
               y = found%x(:, k)
               if (all(merge(abs(wrap_angle(unknowns - y)), abs(unknowns - y)/max(1.0_wp, abs(unknowns)), is_angle) &
                  <= merge(singular_alike, alike, is_singular))) return
            end do
            y = merge(start + wrap_angle(unknowns - start), unknowns, is_angle)
         end associate
         call set_values(e%blocks, i, y, e%state)
         call add_turns(e%blocks, e%geometry, i, e%state)
         if (without_length(e, cylinders_here) > 0) return
         y = values_of(e%blocks, i, e%state)
         square = squares_of(e, guess)
         angles = sqrt(sum(square(1, :), mask=places(1, :) == i))
         distance = sqrt(sum(square, mask=places == i))
         do k = 1, size(found%distance)
            if (is_nearer(distance, found%distance(k))) exit
            if (is_nearer(found%distance(k), distance)) cycle
            first = findloc(abs(y - found%x(:, k)) > alike, .true., dim=1)
            if (first == 0) cycle
            if (y(first) > found%x(first, k)) exit
         end do
         found%x = reshape([found%x(:, :k - 1), y, found%x(:, k:)], [size(y), size(found%x, 2) + 1])
         found%distance = [found%distance(:k - 1), distance, found%distance(k:)]
      end subroutine note_position
   end subroutine find_candidates

   !> (cylinders) The block after which the length of each cylinder of `e` is known; 0: ground alone.
   pure function last_places(e, places) result(last)
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: places(:, :)               !< (2, links) see `places_of`
      integer :: last(size(e%cylinders)), k

      last = [(maxval(places(:, [e%cylinders(k)%i, e%cylinders(k)%j])), k=1, size(last))]
   end function last_places

   !> Finds the pair of the first cylinder of `e` in a list of their numbers that has no length above 0 at the values of
   !> `e`; 0: all have.
   function without_length(e, list) result(pair)
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: list(:)
      integer :: pair
      type(motion_t) :: q
      logical :: finite
      integer :: k

      pair = 0
      if (size(list) == 0) return
      q = new_motion(size(e%estimate, 2))
      call move_links(e%geometry%chain, e%state, e%geometry%equations%length, q, finite, .true.)
      do k = 1, size(list)
         associate (one => e%cylinders(list(k)))
            if (cylinder_length(one, q%position(:, one%i), q%position(:, one%j)) > 0.0_wp) cycle
            pair = one%pair
            return
         end associate
      end do
   end function without_length

   !> (2, links) The block that finds the angle of each link of `e`, and the block after which its place is known; 0:
   !> none.
   pure function places_of(e) result(places)
      type(block_engine_t), intent(in) :: e
      integer :: places(2, size(e%estimate, 2)), block_of(0:e%blocks%unknowns), k

      block_of(0) = 0
      block_of(1:) = e%blocks%block_of
      places = 0
      do k = 1, size(e%geometry%chain%links)
         associate (h => e%geometry%chain%links(k))
            places(1, h%link) = block_of(h%orientation)
            places(2, h%link) = max(block_of(h%orientation), block_of(h%slide))
            if (h%parent > 0) places(2, h%link) = max(places(2, h%link), places(2, h%parent))
            if (h%root > 0) places(2, h%link) = max(places(2, h%link), block_of(h%root), block_of(h%root + 1))
         end associate
      end do
   end function places_of

   !> Whether the distance `one` is less than the distance `other` by more than rounding, which leaves half of all
   !> digits of positions that are about singular.
   elemental logical function is_nearer(one, other) result(is)
      real(wp), intent(in) :: one, other

      is = one < other - rounding*max(other, far_place)
   end function is_nearer

   !> (2, links) See `squared_distances`: how far the links are from `guess` (3, links), at the values that `e` has.
   function squares_of(e, guess) result(square)
      type(block_engine_t), intent(in) :: e
      real(wp), intent(in) :: guess(:, :)
      real(wp) :: square(2, size(guess, 2))
      type(motion_t) :: q
      logical :: finite

      q = new_motion(size(guess, 2))
      call move_links(e%geometry%chain, e%state, e%geometry%equations%length, q, finite, .true.)
      square = squared_distances(q%position, guess, e%geometry%span)
   end function squares_of

   !> The distance from `guess` (3, links) of the assembly that `e` has, of all links that a block moves: `places`.
   real(wp) function distance_of(e, places, guess) result(distance)
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: places(:, :)
      real(wp), intent(in) :: guess(:, :)

      distance = sqrt(sum(squares_of(e, guess), mask=places > 0))
   end function distance_of

   !> (2, links) How far each link at `position` (3, links) is from that of `guess` (3, links): the square of the angle,
   !> in rad, and of the distance, in lengths of `span`.
   pure function squared_distances(position, guess, span) result(square)
      real(wp), intent(in) :: position(:, :), guess(:, :), span
      real(wp) :: square(2, size(position, 2))

      square(1, :) = wrap_angle(position(3, :) - guess(3, :))**2
      square(2, :) = min(sum(((position(:2, :) - guess(:2, :))/span)**2, dim=1), far_place**2)
   end function squared_distances

   !> The closure error at `t` itself, from the motion that is followed or, where that is too far, from the initial
   !> guess; where neither search ends there, `convergence` stays but for its closure error, which is 0.
   subroutine measure_closure_error(e, t, convergence)
      type(block_engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      type(convergence_t), intent(inout) :: convergence
      type(convergence_t) :: before

      before = convergence
      call solve_blocks(e, t, .true., convergence)
      if (convergence%ended == ended_inconsistent) return
      call solve_first(e, t, convergence)
      if (convergence%ended == ended_inconsistent) return
      convergence = before
      convergence%open%value = 0.0_wp
   end subroutine measure_closure_error
end module initial_assembly
