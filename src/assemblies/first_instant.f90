!> The first instant: the assembly that is nearest to the initial guess, by the distance that card ASSEMBLY prints.
!> Newton's method starts from the guess, block by block in solving order. The assembly that it finds is kept if the
!> bound of Newton and Kantorovich leaves no other as near. Otherwise the positions of the blocks are a tree, which is
!> searched depth first, the nearest positions of a block first: what is as far already as the nearest assembly so far is left out.
!>
!> Of a block without a position on any of those chosen before, the others are assembled all the same. All blocks are
!> assembled, also those that no table needs: what is printed chooses no assembly.
module first_instant
   use kinds, only: wp
   use planar, only: without_turns
   use convergence, only: convergence_t, nothing_gathered, is_solved, gather, ended_inconsistent
   use motion, only: motion_t, new_motion
   use blocks, only: largest_known, blocks_below
   use block_state, only: set_values, values_of, add_turns
   use block_solver, only: solve_block
   use link_motion, only: move_links
   use levenberg_marquardt, only: levenberg_marquardt_solve, find_closure_error
   use block_engine, only: block_engine_t, choice_t, solve_blocks, solve_each, separation_of
   use block_branches, only: is_short_and_right
   use block_assemblies, only: block_positions_t, find_positions
   implicit none
   private
   public :: solve_first, solve_instant, measure_closure_error, places_of, squared_distances, is_nearer, alike

   !> More than any distance; its square is in range.
   real(wp), parameter :: unbounded = 0.5_wp*sqrt(huge(1.0_wp))

   !> What assemblies are compared with: the places and angles of the deck, or angles that its places imply.
   type :: guess_t
      real(wp), allocatable :: position(:, :)           !< (3, links)
      integer, allocatable :: places(:, :)              !< (2, links) see `places_of`
   end type guess_t

   !> Positions of one block, nearest to the guess first.
   type :: candidates_t
      real(wp), allocatable :: x(:, :)                  !< (unknowns of the block, positions)
      real(wp), allocatable :: distance(:)              !< (positions) see `squared_distances`
      real(wp) :: beyond = unbounded                    !< the distance of positions not looked for, at least
      logical :: are_all = .true.                       !< no nearer one can be missing
      integer :: chosen = 0                             !< the number of that in use; 0: not looked for yet
   end type candidates_t

   !> The nearest assembly that was found so far.
   type :: nearest_t
      real(wp) :: distance = unbounded
      logical :: is_cut = .false.                       !< the search was ended before its end
      type(candidates_t), allocatable :: found(:)       !< (blocks)
      type(convergence_t), allocatable :: failure(:)    !< (blocks) how the search ended where there is no position
   end type nearest_t

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

   !> Solves for the motion at `t`, from the one accepted last (`follows`) or nearest to the initial guess. `c`: how it
   !> ended, with the largest change (rad, `length`) of a predicted value.
   subroutine solve_instant(e, t, follows, c)
      type(block_engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      logical, intent(in) :: follows
      type(convergence_t), intent(inout) :: c

      if (follows) then
         call solve_blocks(e, t, follows, c)
         if (e%state%excursion > 0.0_wp .and. is_solved(c)) c%is_certain = is_short_and_right(e, c%change)
      else
         call solve_first(e, t, c)
      end if
   end subroutine solve_instant

   !> Solves for the first motion at `t`. `c`: how that ended.
   subroutine solve_first(e, t, c)
      type(block_engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      type(convergence_t), intent(out) :: c
      type(guess_t) :: guess, deck_guess
      type(nearest_t) :: nearest, deck_nearest
      type(convergence_t) :: rest
      logical :: is_implied(size(e%estimate, 2)), is_complete
      integer :: k, i

      call solve_blocks(e, t, .false., c)
      if (.not. e%blocks%solvable) return
      rest = nothing_gathered
      if (is_solved(c) .and. size(e%needed) < size(e%blocks%list)) call solve_each(e, &
         pack([(i, i=1, size(e%blocks%list))], [(all(e%needed /= i), i=1, size(e%blocks%list))]), .false., rest)
      is_complete = is_solved(c) .and. is_solved(rest)
      call make_guess(e, guess, is_implied)
      if (is_complete .and. .not. any(is_implied)) then
         if (is_alone(e, guess)) return
      end if

      e%choice = choice_t()
      if (any(is_implied)) then
         deck_guess = guess_t(e%estimate, guess%places)
         call find_nearest(e, deck_guess, is_complete, deck_nearest)
      end if
      call find_nearest(e, guess, is_complete, nearest)
      do i = 1, size(nearest%found)
         associate (one => nearest%found(i), choice => e%choice(i))
            if (one%chosen == 0) cycle
            choice%is_incomplete = .not. one%are_all .or. (nearest%is_cut .and. size(one%distance) > 1)
            if (one%chosen == 1 .and. size(one%distance) > 1) &
               choice%is_close = one%distance(1) > about_equal*one%distance(2)
         end associate
      end do
      if (any(is_implied)) then
         ! By the angles of the deck another assembly may be nearer.
         if (is_nearer(deck_nearest%distance, sqrt(sum(squares_of(e, deck_guess), mask=guess%places > 0)))) &
            e%choice(pack(guess%places(1, :), is_implied))%is_incomplete = .true.
      end if
      c = nothing_gathered
      k = findloc(nearest%found(e%needed)%chosen, 0, dim=1)
      if (k == 0) then
         call solve_each(e, e%needed, .false., c)
      else
         call solve_each(e, e%needed(:k - 1), .false., c)
         if (is_solved(c)) call gather(nearest%failure(e%needed(k)), c)
      end if
   end subroutine solve_first

   !> Makes `guess`, with which the positions of `e` compete: the estimate of the deck, in which places may imply other
   !> angles of some links: `is_implied` (links).
   subroutine make_guess(e, guess, is_implied)
      type(block_engine_t), intent(in) :: e
      type(guess_t), intent(out) :: guess
      logical, intent(out) :: is_implied(:)
      real(wp) :: turn(0:e%blocks%orientations)
      integer :: k

      guess = guess_t(e%estimate, places_of(e))
      turn = 0.0_wp
      associate (class => e%orientation_of, offset => e%blocks%numbers%equations%axes%angle_offset)
         ! The angle of a class is that of its first link.
         do k = size(class), 1, -1
            if (class(k) > 0) turn(class(k)) = &
               without_turns(e%estimated(class(k)) + offset(k) - e%estimate(3, k))
         end do
         is_implied = abs(turn(class)) > alike
         guess%position(3, :) = guess%position(3, :) + turn(class)
      end associate
   end subroutine make_guess

   !> Whether no other assembly can be about as near to `guess` as the one that `e` has: of the first block that differs
   !> an angle is off by the separation of its positions, at least.
   logical function is_alone(e, guess) result(is)
      type(block_engine_t), intent(in) :: e
      type(guess_t), intent(in) :: guess
      real(wp) :: square(2, size(e%estimate, 2)), behind
      integer :: i

      square = squares_of(e, guess)
      behind = 0.0_wp
      is = .true.
      do i = size(e%blocks%list), 1, -1
         behind = behind + sum(square, mask=guess%places == i)
         if (e%blocks%list(i)%direct) cycle
         is = about_equal*(e%choice(i)%separation - sqrt(sum(square(1, :), mask=guess%places(1, :) == i))) >= sqrt(behind)
         if (.not. is) return
      end do
   end function is_alone

   !> (2, links) See `squared_distances`: of the values that `e` has, from `guess`.
   function squares_of(e, guess) result(square)
      type(block_engine_t), intent(in) :: e
      type(guess_t), intent(in) :: guess
      real(wp) :: square(2, size(e%estimate, 2))
      type(motion_t) :: q
      logical :: finite

      q = new_motion(size(square, 2))
      call move_links(e%chain, e%state, e%length, q, finite, .true.)
      square = squared_distances(q%position, guess%position, e%blocks%numbers%span)
   end function squares_of

   !> Puts the assembly that is `nearest` to `guess` into the values of `e`; if there is none, the positions of the
   !> blocks that have one. `is_complete`: `e` has an assembly, and further ones do not count.
   subroutine find_nearest(e, guess, is_complete, nearest)
      type(block_engine_t), intent(inout) :: e
      type(guess_t), intent(in) :: guess
      logical, intent(in) :: is_complete
      type(nearest_t), intent(out) :: nearest
      type(candidates_t) :: found(size(e%blocks%list))
      type(convergence_t) :: failure(size(found))       !< how the search for a position ended where there is none
      logical :: is_given_up(size(found))               !< other positions of the blocks below do not help
      integer :: latest(size(found))                    !< the last block below that iterates; 0: none
      integer :: seen(size(found))                      !< how many choices there were when its positions were found
      integer, dimension(0:e%blocks%unknowns) :: open, changed, last !< 1: not found; the choice that changed it; `latest`
      real(wp) :: spent(0:size(found))                  !< the square of the distance of all blocks up to this one
      real(wp) :: values(0:e%blocks%unknowns)           !< of the nearest assembly
      real(wp) :: limit                                 !< distance from which on assemblies do not count
      integer, allocatable :: below(:)
      integer :: i, k, solves, choices

      values = e%state%u%value
      limit = unbounded
      if (is_complete) limit = sqrt(sum(squares_of(e, guess), mask=guess%places > 0))
      if (is_complete) limit = limit + alike*max(1.0_wp, limit)
      last = 0
      do i = 1, size(found)
         latest(i) = largest_known(e%blocks, i, last)
         last(own_of(i)) = merge(latest(i), i, e%blocks%list(i)%direct)
         call set_values(e%blocks, i, e%estimated(own_of(i)), e%state)
      end do
      is_given_up = .false.
      open = 0
      changed = 0
      seen = -1
      spent = 0.0_wp
      choices = 0
      solves = 0
      i = 1
      do
         k = 0
         if (i > size(found)) then
            if (.not. allocated(nearest%found) .or. is_nearer(sqrt(spent(i - 1)), limit)) call note_assembly()
            if (all(found%chosen > 0)) k = last_promising([(k, k=1, size(found))])
            if (k == 0) exit
         else if (largest_known(e%blocks, i, open) > 0) then
            call leave_open()
            cycle
         else
            open(own_of(i)) = 0
            if (found(i)%chosen == 0) call look_for_positions()
            if (last_promising([i]) > 0) then
               call take_next_position()
               cycle
            end if
            nearest%is_cut = solves > max_solves
            if (limit < unbounded) then
               if (.not. nearest%is_cut) k = last_promising([(k, k=1, i - 1)])
               if (k == 0) exit
            else
               ! Back to the last of the blocks below that has another position. If none helps, this one is left open.
               if (.not. (is_given_up(i) .or. nearest%is_cut)) then
                  below = blocks_below(e%blocks, i)
                  below = below(:size(below) - 1)
                  k = last_promising(below)
                  is_given_up(i) = k == 0
                  if (k == 0 .and. any(found(below)%chosen > 1)) then
                     found%chosen = 0
                     i = 1
                     cycle
                  end if
               end if
               if (k == 0) call leave_open()
               if (k == 0) cycle
            end if
         end if
         ! The blocks after it begin again.
         found(k + 1:)%chosen = 0
         i = k
      end do
      if (.not. allocated(nearest%found)) then
         found%chosen = 1
         call note_assembly()
      end if
      do i = 1, size(found)
         call set_values(e%blocks, i, values(own_of(i)), e%state)
      end do
      nearest%failure = failure

   contains

      !> The unknowns of block `k`.
      pure function own_of(k) result(own)
         integer, intent(in) :: k
         integer, allocatable :: own(:)

         own = e%blocks%unknown(e%blocks%list(k)%first:e%blocks%list(k)%last)
      end function own_of

      !> Finds the positions of block `i`, unless those that are known still hold.
      subroutine look_for_positions()
         real(wp) :: budget

         budget = sqrt(max(0.0_wp, limit**2 - spent(i - 1)))
         if (largest_known(e%blocks, i, changed) <= seen(i) .and. about_equal*found(i)%beyond >= budget) return
         call find_candidates(e, i, guess, budget, found(i), failure(i))
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

      !> Takes the next position of block `i`.
      subroutine take_next_position()
         associate (one => found(i))
            one%chosen = one%chosen + 1
            call set_values(e%blocks, i, one%x(:, one%chosen), e%state)
            spent(i) = spent(i - 1) + one%distance(one%chosen)**2
         end associate
         choices = choices + 1
         changed(own_of(i)) = choices
         i = i + 1
      end subroutine take_next_position

      !> Leaves block `i` without a position.
      subroutine leave_open()
         found(i)%chosen = 0
         spent(i) = spent(i - 1)
         open(own_of(i)) = 1
         call set_values(e%blocks, i, e%estimated(own_of(i)), e%state)
         i = i + 1
      end subroutine leave_open

      !> Notes the assembly that `e` has as the nearest so far.
      subroutine note_assembly()
         nearest%found = found
         values = e%state%u%value
         if (any(found%chosen == 0)) return
         nearest%distance = sqrt(spent(size(found)))
         limit = nearest%distance
      end subroutine note_assembly
   end subroutine find_nearest

   !> Finds the positions `found` of block `i`, for the values that `e` has of earlier blocks. Others than that of
   !> Newton's method are not looked for if all of them are further from `guess` than the distance `budget`. `c`: how
   !> the search ended; where there is no position, with the closure error that remains.
   subroutine find_candidates(e, i, guess, budget, found, c)
      type(block_engine_t), intent(inout) :: e
      integer, intent(in) :: i
      type(guess_t), intent(in) :: guess
      real(wp), intent(in) :: budget
      type(candidates_t), intent(out) :: found
      type(convergence_t), intent(out) :: c
      type(block_positions_t) :: every
      real(wp), dimension(e%blocks%list(i)%shape%n) :: start, least
      real(wp) :: angles
      integer :: k

      allocate (found%x(size(start), 0), found%distance(0))
      start = e%estimated(e%blocks%unknown(e%blocks%list(i)%first:e%blocks%list(i)%last))
      call set_values(e%blocks, i, start, e%state)
      call solve_block(e%blocks, i, e%tolerance, e%work, e%state, c)
      if (is_solved(c)) call note_position(values_of(e%blocks, i, e%state), c%singular)
      if (e%blocks%list(i)%direct) return
      if (is_solved(c)) then
         found%beyond = separation_of(e%blocks, i, e%state, c) - angles
         if (about_equal*found%beyond >= budget) return
         found%beyond = unbounded
      end if

      call find_positions(e%blocks, i, e%tolerance, e%work, e%state, max_group, e%starts(i)%paths, every)
      do k = 1, size(every%sign_of)
         call note_position(every%x(:, k), every%sign_of(k) == 0)
      end do
      ! There is one more if that of Newton's method is none of them.
      found%are_all = .not. (every%moves .or. every%is_wide .or. every%failed > 0) &
         .and. size(found%distance) <= size(every%sign_of)
      if (found%are_all .and. size(found%distance) > 0) return
      call set_values(e%blocks, i, start, e%state)
      call levenberg_marquardt_solve(e%blocks, i, e%state)
      least = values_of(e%blocks, i, e%state)
      call solve_block(e%blocks, i, e%tolerance, e%work, e%state, c)
      if (is_solved(c)) then
         call note_position(values_of(e%blocks, i, e%state), c%singular)
      else
         call set_values(e%blocks, i, least, e%state)
         call find_closure_error(e%blocks, i, e%state, c)
      end if

   contains

      !> Puts the position `x` in its place among those found, unless it is there already. Its angles are brought within
      !> half a turn of the guess; drives between two angles then add whole turns. Of two that are as near, that with
      !> the greater first value: rounding shall not choose.
      subroutine note_position(x, is_singular)
         real(wp), intent(in) :: x(:)
         logical, intent(in) :: is_singular
         real(wp) :: y(size(x)), square(2, size(guess%places, 2)), distance
         integer :: k, first

         associate (is_angle => e%blocks%unknown(e%blocks%list(i)%first:e%blocks%list(i)%last) <= e%blocks%orientations)
            do k = 1, size(found%distance)
               y = found%x(:, k)
               if (all(merge(abs(without_turns(x - y)), abs(x - y)/max(1.0_wp, abs(x)), is_angle) &
                  <= merge(singular_alike, alike, is_singular))) return
            end do
            y = merge(start + without_turns(x - start), x, is_angle)
         end associate
         call set_values(e%blocks, i, y, e%state)
         call add_turns(e%blocks, i, e%state)
         y = values_of(e%blocks, i, e%state)
         square = squares_of(e, guess)
         angles = sqrt(sum(square(1, :), mask=guess%places(1, :) == i))
         distance = sqrt(sum(square, mask=guess%places == i))
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

   !> (2, links) The block that finds the angle of each link of `e`, and the block after which its place is known; 0:
   !> none.
   pure function places_of(e) result(places)
      type(block_engine_t), intent(in) :: e
      integer :: places(2, size(e%estimate, 2)), block_of(0:e%blocks%unknowns), k

      block_of(0) = 0
      block_of(1:) = e%blocks%block_of
      places = 0
      do k = 1, size(e%chain%links)
         associate (h => e%chain%links(k))
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

   !> (2, links) How far each link at `position` (3, links) is from that of `guess` (3, links): the square of the angle,
   !> in rad, and of the distance, in lengths of `span`.
   pure function squared_distances(position, guess, span) result(square)
      real(wp), intent(in) :: position(:, :), guess(:, :), span
      real(wp) :: square(2, size(position, 2))

      square(1, :) = without_turns(position(3, :) - guess(3, :))**2
      square(2, :) = min(sum(((position(:2, :) - guess(:2, :))/span)**2, dim=1), far_place**2)
   end function squared_distances

   !> The closure error at `t` itself, from the motion that is followed or, where that is too far, from the initial
   !> guess; where neither search ends there, `c` stays but for its closure error, which is 0.
   subroutine measure_closure_error(e, t, c)
      type(block_engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      type(convergence_t), intent(inout) :: c
      type(convergence_t) :: before

      before = c
      call solve_blocks(e, t, .true., c)
      if (c%ended == ended_inconsistent) return
      call solve_first(e, t, c)
      if (c%ended == ended_inconsistent) return
      c = before
      c%open%value = 0.0_wp
   end subroutine measure_closure_error
end module first_instant
