!> The first instant: the assembly that is nearest to the initial guess, block by block in solving order. Newton's
!> method starts from the guess. Unless no other position of the block can be as near, all its positions compete with
!> the one that Newton's method finds, by the distance that card ASSEMBLY prints.
!>
!> A block that has no position on those chosen before takes the next nearest of them. All blocks are assembled, also
!> those that no table needs: what is printed chooses no assembly.
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
   use block_engine, only: block_engine_t, choice_t, solve_blocks, solve_each, is_certain
   use block_branches, only: is_short_and_right
   use block_assemblies, only: block_positions_t, find_positions
   implicit none
   private
   public :: solve_first, solve_instant, measure_closure_error, places_of, squared_distances, alike, equal

   !> Positions of one block, nearest to the guess first.
   type :: candidates_t
      real(wp), allocatable :: x(:, :)                  !< (unknowns of the block, positions)
      real(wp), allocatable :: distance(:)              !< (positions) see `squared_distances`
      logical :: are_all = .true.                       !< no nearer one can be missing
      integer :: chosen = 0                             !< the number of that in use; 0: not looked for yet
   end type candidates_t

   !> All positions are enumerated of blocks of so many unknowns in each of both groups: eight in all, 70 paths.
   integer, parameter :: max_group = 4
   !> Places count as off by no more than this part of the characteristic length: a deck may give angles alone.
   real(wp), parameter :: far_place = 0.25_wp
   !> Positions that differ by less (rad, characteristic lengths) are one; of singular ones half of all digits is known.
   real(wp), parameter :: alike = max(1.0e-5_wp, 16.0_wp*sqrt(epsilon(1.0_wp))), singular_alike = sqrt(alike)
   !> Distances of which one is this part of the other or more are equal; those of which it is this part are about so.
   real(wp), parameter :: equal = 0.999_wp, about_equal = 0.8_wp
   !> The largest number of blocks assembled.
   integer, parameter :: max_solves = 3000

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
      type(candidates_t), allocatable :: found(:)
      type(convergence_t), allocatable :: failure(:)
      integer :: k, i

      call solve_blocks(e, t, .false., c)
      if (.not. e%blocks%solvable) return
      if (all(e%choice(e%needed)%is_certain)) return

      call choose(e, found, failure)
      e%choice = choice_t()
      do i = 1, size(found)
         associate (one => found(i), choice => e%choice(i))
            if (one%chosen == 0) cycle
            choice%is_incomplete = .not. one%are_all
            if (one%chosen == 1 .and. size(one%distance) > 1) &
               choice%is_close = one%distance(1) > about_equal*one%distance(2)
         end associate
      end do
      c = nothing_gathered
      k = findloc(found(e%needed)%chosen, 0, dim=1)
      if (k == 0) then
         call solve_each(e, e%needed, .false., c)
      else
         call solve_each(e, e%needed(:k - 1), .false., c)
         if (is_solved(c)) call gather(failure(e%needed(k)), c)
      end if
   end subroutine solve_first

   !> Puts the nearest assembly into the values of `e`. `found` (blocks): their positions; `failure` (blocks): how the
   !> search for a position ended where there is none.
   subroutine choose(e, found, failure)
      type(block_engine_t), intent(inout) :: e
      type(candidates_t), allocatable, intent(out) :: found(:)
      type(convergence_t), allocatable, intent(out) :: failure(:)
      integer, allocatable :: below(:)
      logical :: is_given_up(size(e%blocks%list))       !< other positions of the blocks below do not help
      integer :: open(0:e%blocks%unknowns)              !< 1: of a block without a position
      real(wp) :: guess(3, size(e%estimate, 2))
      integer :: places(2, size(e%estimate, 2)), i, k, solves
      type(motion_t) :: q
      logical :: finite

      allocate (found(size(e%blocks%list)), failure(size(e%blocks%list)))
      places = places_of(e)
      ! The angles are those that Newton's method starts from: places may contradict the angles of the deck.
      do i = 1, size(found)
         associate (own => e%blocks%unknown(e%blocks%list(i)%first:e%blocks%list(i)%last))
            call set_values(e%blocks, i, e%estimated(own), e%state)
         end associate
      end do
      q = new_motion(size(places, 2))
      call move_links(e%chain, e%state, e%length, q, finite, .true.)
      guess(:2, :) = e%estimate(:2, :)
      guess(3, :) = q%position(3, :)
      is_given_up = .false.
      open = 0
      solves = 0
      i = 1
      do while (i <= size(found))
         associate (own => e%blocks%unknown(e%blocks%list(i)%first:e%blocks%list(i)%last), one => found(i))
            open(own) = 0
            if (largest_known(e%blocks, i, open) == 0) then
               if (one%chosen == 0) then
                  call find_candidates(e, i, places, guess, one, failure(i))
                  solves = solves + 1
               end if
               if (one%chosen < size(one%distance)) then
                  one%chosen = one%chosen + 1
                  call set_values(e%blocks, i, one%x(:, one%chosen), e%state)
                  i = i + 1
                  cycle
               end if

               ! Back to the last of the blocks below that has another position; the blocks after it begin again.
               if (.not. is_given_up(i) .and. solves < max_solves) then
                  below = blocks_below(e%blocks, i)
                  do k = size(below) - 1, 1, -1
                     if (found(below(k))%chosen < size(found(below(k))%distance)) exit
                  end do
                  is_given_up(i) = k == 0
                  if (k > 0 .or. any(found(below(:size(below) - 1))%chosen > 1)) then
                     i = 1
                     if (k > 0) i = below(k)
                     found(merge(i + 1, 1, k > 0):)%chosen = 0
                     cycle
                  end if
               end if
            end if
            one%chosen = 0
            open(own) = 1
            call set_values(e%blocks, i, e%estimated(own), e%state)
            i = i + 1
         end associate
      end do
   end subroutine choose

   !> Finds the positions `found` of block `i`, for the values that `e` has of earlier blocks. `places`: see
   !> `places_of`; `guess` (3, links). `c`: how the search ended; where there is no position, with the closure error
   !> that remains.
   subroutine find_candidates(e, i, places, guess, found, c)
      type(block_engine_t), intent(inout) :: e
      integer, intent(in) :: i, places(:, :)
      real(wp), intent(in) :: guess(:, :)
      type(candidates_t), intent(out) :: found
      type(convergence_t), intent(out) :: c
      type(block_positions_t) :: every
      real(wp), dimension(e%blocks%list(i)%shape%n) :: start, least
      integer :: k

      allocate (found%x(size(start), 0), found%distance(0))
      start = e%estimated(e%blocks%unknown(e%blocks%list(i)%first:e%blocks%list(i)%last))
      call set_values(e%blocks, i, start, e%state)
      call solve_block(e%blocks, i, e%tolerance, e%work, e%state, c)
      if (is_solved(c)) call note_position(values_of(e%blocks, i, e%state), c%singular)
      if (e%blocks%list(i)%direct .or. is_certain(c)) return

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
         real(wp) :: y(size(x)), square(2, size(places, 2)), distance
         type(motion_t) :: q
         integer :: k, first
         logical :: finite

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
         q = new_motion(size(places, 2))
         call move_links(e%chain, e%state, e%length, q, finite, .true.)
         square = squared_distances(q%position, guess, e%blocks%numbers%span)
         distance = sqrt(sum(square, mask=places == i))
         do k = 1, size(found%distance)
            if (distance < equal*found%distance(k)) exit
            if (found%distance(k) < equal*distance) cycle
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
