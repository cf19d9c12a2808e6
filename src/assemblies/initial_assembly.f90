!> The first instant: the assembly that is nearest to the initial guess, by the distance that card ASSEMBLY prints.
!> Newton's method starts from the guess, block by block in solving order. Its assembly is kept if the bound of Newton
!> and Kantorovich leaves no other assembly as near. Otherwise a search goes through the positions of the blocks, depth
!> first and the nearest first. It leaves out all positions that are further than the nearest assembly so far.
!>
!> All blocks are assembled, also those that no table needs: the rows on paper choose no assembly. If a block has no
!> position with any positions of the blocks on which it builds, the other blocks are assembled without it.
module initial_assembly
   use kinds, only: wp
   use plane_vectors, only: wrap_angle
   use cylinders, only: cylinder_length
   use convergence, only: solve_report_t, nothing_gathered, is_solved, gather, ended_elsewhere
   use motion, only: motion_t, new_motion
   use blocks, only: blocks_t, geometry_t, largest_known, blocks_below, own_unknowns
   use block_state, only: state_t, set_values, values_of, add_turns
   use block_solver, only: workspace_t, solve_blocks, solve_block
   use link_motion, only: move_links
   use levenberg_marquardt, only: levenberg_marquardt_solve, find_closure_error
   use initial_estimate, only: guess_t, first_choice_t
   use block_assemblies, only: block_positions_t, find_positions
   implicit none
   private
   public :: solve_first, places_of, squared_distances, is_nearer, same_assembly_tolerance

   !> The distance of no assembly: above any distance, and its square is in range.
   real(wp), parameter :: no_distance = 0.5_wp*sqrt(huge(1.0_wp))

   !> Positions of one block, nearest to the guess first.
   type :: candidates_t
      real(wp), allocatable :: x(:, :)                  !< (unknowns of the block, positions) rad or unit of the loop
      real(wp), allocatable :: distance(:)              !< (positions) from the guess: roots of `squared_distances`
      real(wp) :: beyond = no_distance                  !< lower bound of the distance of positions not searched for
      logical :: are_all = .true.                       !< no nearer position can be missing
      integer :: chosen = 0                             !< the number of the position in use; 0: none
      type(solve_report_t) :: ending                    !< of Newton's method for the block
   end type candidates_t

   !> Unknowns of a group at most if all positions are enumerated: eight in both groups, 70 paths. More would delay
   !> every deck.
   integer, parameter :: max_first_group = 4
   !> The distance of a link from its guess counts up to this part of the characteristic length: a deck may give only
   !> angles.
   real(wp), parameter :: max_position_offset = 0.25_wp
   !> Positions that differ by less are one (rad, characteristic lengths).
   real(wp), parameter :: same_assembly_tolerance = max(1.0e-5_wp, 16.0_wp*sqrt(epsilon(1.0_wp)))
   !> Singular positions that differ by less are one: half of their digits is known.
   real(wp), parameter :: same_singular_assembly_tolerance = sqrt(same_assembly_tolerance)
   !> Two distances are about equal if one is at least this part of the other.
   real(wp), parameter :: about_equal = 0.8_wp
   !> Searches for positions of a block at most: combinations of positions grow exponentially with the blocks.
   integer, parameter :: max_solves = 3000
   !> Distances that differ by less than this part are equal: rounding shall not choose.
   real(wp), parameter :: equal_distance_part = 64.0_wp*sqrt(epsilon(1.0_wp))

contains

   !> Solves for the first motion, in the assembly that is nearest to the guess. If there is no assembly, needed blocks
   !> before the first needed block without a position are solved.
   subroutine solve_first(b, x, guess, w, s, convergence)
      type(blocks_t), intent(in) :: b        !< solvable, with its needed blocks
      type(geometry_t), intent(in) :: x
      type(guess_t), intent(inout) :: guess  !< by `assign_guess`; its angles get whole turns, its choices are set
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s      !< with the values of the drives; then the first motion
      type(solve_report_t), intent(out) :: convergence   !< of the needed blocks, or of the block without a position
      type(candidates_t), dimension(size(b%list)) :: found, by_deck
      type(solve_report_t) :: rest
      real(wp) :: implied(3, size(guess%links, 2)), turn(0:b%orientations), nearest
      logical :: is_complete, is_implied(size(implied, 2))
      integer :: finders(2, size(implied, 2)), k, i

      ! The guess takes over the whole turns of the drives: otherwise Newton's method would have to go through them.
      s%u%value = guess%values
      do k = 1, size(b%needed)
         if (.not. b%list(b%needed(k))%explicit) call add_turns(b, x, b%needed(k), s)
      end do
      guess%values(:) = s%u%value
      guess%choice = first_choice_t()

      call solve_blocks(b, x, b%needed, w, s, convergence)
      rest = nothing_gathered
      if (is_solved(convergence)) call solve_blocks(b, x, pack([(i, i=1, size(found))], &
         [(all(b%needed /= i), i=1, size(found))]), w, s, rest)
      finders = places_of(b, x)
      is_complete = is_solved(convergence) .and. is_solved(rest)
      if (is_complete) is_complete = without_length(x, s, [(i, i=1, size(x%cylinders))]) == 0

      ! The guess may have better angles than the deck: the links of a class turn by the angle of its first link.
      turn = 0.0_wp
      associate (class => b%tree%orientation, offset => x%equations%axes%angle_offset)
         do k = size(class), 1, -1
            if (class(k) > 0) turn(class(k)) = wrap_angle(guess%values(class(k)) + offset(k) - guess%links(3, k))
         end do
         is_implied = abs(turn(class)) > same_assembly_tolerance
         implied = guess%links
         implied(3, :) = implied(3, :) + turn(class)
      end associate
      if (is_complete .and. .not. any(is_implied)) then
         if (is_certified_nearest(b, x, s, finders, implied)) return
      end if

      nearest = no_distance
      if (any(is_implied)) call find_nearest(b, x, guess, w, s, finders, &
         guess%links, is_complete, by_deck, nearest)
      call find_nearest(b, x, guess, w, s, finders, implied, is_complete, found)
      do i = 1, size(found)
         associate (one => found(i), choice => guess%choice(i))
            if (one%chosen == 0) cycle
            choice%is_incomplete = .not. one%are_all
            if (one%chosen == 1 .and. size(one%distance) > 1) &
               choice%is_close = one%distance(1) > about_equal*one%distance(2)
         end associate
      end do

      if (is_nearer(nearest, distance_of(x, s, finders, guess%links))) &
         guess%choice(pack(finders(1, :), is_implied))%is_incomplete = .true.
      k = findloc(found(b%needed)%chosen, 0, dim=1)
      if (k == 0) then
         call solve_blocks(b, x, b%needed, w, s, convergence)
      else
         call solve_blocks(b, x, b%needed(:k - 1), w, s, convergence)
         if (is_solved(convergence)) call gather(found(b%needed(k))%ending, convergence)
      end if
   end subroutine solve_first

   !> Tells whether no other assembly can be about as near to the goal as the assembly in `s`. There is none if the
   !> assembly is at the goal itself. Otherwise, in another assembly, an angle of the first block that differs is off by
   !> the separation of the block's positions, at least.
   logical function is_certified_nearest(b, x, s, finders, goal) result(is)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(state_t), intent(in) :: s                    !< with an assembly
      integer, intent(in) :: finders(:, :)               !< (2, links) blocks that find angle and position; 0: none
      real(wp), intent(in) :: goal(:, :)                !< (3, links) x and y from the origin of the chain, rad
      real(wp) :: square(2, size(goal, 2)), later
      integer :: i

      square = squares_of(x, s, goal)
      is = sqrt(sum(square)) <= same_assembly_tolerance
      if (is) return
      later = 0.0_wp
      is = .true.
      do i = size(b%list), 1, -1
         later = later + sum(square, mask=finders == i)
         if (.not. b%list(i)%explicit) is = about_equal*(separation_of(b, x, i, s) &
            - sqrt(sum(square(1, :), mask=finders(1, :) == i))) >= sqrt(later)
         if (.not. is) return
      end do
   end function is_certified_nearest

   !> Puts the assembly that is nearest to the goal into the values of `s`. If there is none, it puts the positions of
   !> the blocks that have one.
   subroutine find_nearest(b, x, guess, w, s, finders, goal, is_complete, found, distance)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(guess_t), intent(inout) :: guess             !< where Newton's method starts; starts of paths may be added
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s                 !< with the drives; then the values of the nearest assembly
      integer, intent(in) :: finders(:, :)               !< (2, links) blocks that find angle and position; 0: none
      real(wp), intent(in) :: goal(:, :)                !< (3, links) x and y from the origin of the chain, rad
      logical, intent(in) :: is_complete                !< `s` has an assembly: assemblies further away do not count
      type(candidates_t), intent(out) :: found(:)       !< (blocks) their positions; the chosen ones are the assembly
      !> Of the nearest assembly: sqrt(sum(`squared_distances`)); without an assembly `no_distance`.
      real(wp), intent(out), optional :: distance       !< rad and characteristic lengths

      type(candidates_t), allocatable :: nearest(:)     !< with the nearest assembly so far; not allocated: none
      real(wp) :: values(0:b%unknowns)                  !< of the nearest assembly
      real(wp) :: limit                                 !< assemblies at this distance or more do not count
      real(wp) :: spent(0:size(found))                  !< the square of the distance of all blocks up to this one
      integer :: latest(size(found))                    !< the last block below it that iterates; 0: none
      integer :: seen(size(found))                      !< the number of the choice after which its positions were found
      integer, dimension(0:b%unknowns) :: changed       !< the number of the choice that changed it last
      integer, dimension(0:b%unknowns) :: missing       !< 1: its block has no position; otherwise 0
      logical :: is_given_up(size(found))               !< no other positions of blocks below it give it a position
      integer, allocatable :: below(:)
      integer :: i, k, solves, choices

      values = s%u%value
      limit = no_distance
      if (is_complete) limit = distance_of(x, s, finders, goal)
      if (is_complete) limit = limit + same_assembly_tolerance*max(1.0_wp, limit)

      latest = iterating_below(b)
      do i = 1, size(found)
         call set_values(b, i, guess%values(own_unknowns(b, i)), s)
         allocate (found(i)%x(b%list(i)%shape%n, 0), found(i)%distance(0))
      end do
      is_given_up = .false.
      missing = 0
      changed = 0
      seen = -1
      spent = 0.0_wp
      choices = 0
      solves = 0
      i = 1

      do while (i > 0)
         if (i > size(found)) then
            ! An assembly, or as many blocks as can be assembled.
            nearest = found
            values = s%u%value
            if (any(found%chosen == 0)) exit
            limit = sqrt(spent(size(found)))
            i = last_promising(b, [(k, k=1, size(found))], found, latest, seen, changed, spent, limit)
            found(i + 1:)%chosen = 0

         else
            associate (own => own_unknowns(b, i))
               missing(own) = 0
               if (largest_known(b, i, missing) == 0) then
                  if (found(i)%chosen == 0) call search_positions()
                  if (last_promising(b, [i], found, latest, seen, changed, spent, limit) == i) then
                     found(i)%chosen = found(i)%chosen + 1
                     call set_values(b, i, found(i)%x(:, found(i)%chosen), s)
                     spent(i) = spent(i - 1) + found(i)%distance(found(i)%chosen)**2
                     choices = choices + 1
                     changed(own) = choices
                     i = i + 1
                     cycle
                  end if

                  ! Back to the last block that has another position; only to a block below if this block has none.
                  below = [(k, k=1, i)]
                  if (size(found(i)%distance) == 0 .or. .not. limit < no_distance) below = blocks_below(b, i)
                  below = below(:size(below) - 1)
                  k = 0
                  if (solves < max_solves .and. .not. is_given_up(i)) &
                     k = last_promising(b, below, found, latest, seen, changed, spent, limit)
                  if (k == 0 .and. limit < no_distance) exit
                  if (k > 0 .or. (.not. is_given_up(i) .and. any(found(below)%chosen > 1))) then
                     is_given_up(i) = k == 0
                     i = max(1, k)
                     found(merge(i + 1, 1, k > 0):)%chosen = 0
                     cycle
                  end if
               end if

               found(i)%chosen = 0
               spent(i) = spent(i - 1)
               missing(own) = 1
               call set_values(b, i, guess%values(own), s)
               i = i + 1
            end associate
         end if
      end do

      if (.not. allocated(nearest)) found%chosen = 1
      if (allocated(nearest)) found = nearest
      do i = 1, size(found)
         if (solves >= max_solves .and. size(found(i)%distance) > 1) found(i)%are_all = .false.
         call set_values(b, i, values(own_unknowns(b, i)), s)
      end do
      if (present(distance)) distance = merge(limit, no_distance, allocated(nearest) .and. all(found%chosen > 0))

   contains

      !> Finds the positions of block `i`, unless its last search still holds: no block below has changed since, and
      !> positions that were not searched for are too far.
      subroutine search_positions()
         real(wp) :: budget

         budget = sqrt(max(0.0_wp, limit**2 - spent(i - 1)))
         if (largest_known(b, i, changed) <= seen(i) .and. about_equal*found(i)%beyond >= budget) return
         call find_candidates(b, x, guess, w, s, i, finders, goal, budget, found(i))
         seen(i) = choices
         solves = solves + 1
      end subroutine search_positions
   end subroutine find_nearest

   !> Gives for each block (blocks) the last block on which it builds that is not explicit; 0: there is none.
   pure function iterating_below(b) result(latest)
      type(blocks_t), intent(in) :: b
      integer :: latest(size(b%list)), last(0:b%unknowns), i   ! last: as `latest`, for each unknown

      last = 0
      do i = 1, size(latest)
         latest(i) = largest_known(b, i, last)
         last(own_unknowns(b, i)) = merge(latest(i), i, b%list(i)%explicit)
      end do
   end function iterating_below

   !> Finds the last block of a list that has another position with which an assembly can be nearer than a limit; 0: no
   !> block has one. Later blocks whose positions do not change with it are, at best, as near as their nearest position.
   pure integer function last_promising(b, list, found, latest, seen, changed, spent, limit) result(k)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: list(:)                    !< (any number) numbers of blocks, in increasing order
      type(candidates_t), intent(in) :: found(:)        !< (blocks) their positions
      integer, intent(in) :: latest(:)                  !< (blocks) the last block below that iterates; 0: none
      integer, intent(in) :: seen(:)                    !< (blocks) the number of the choice after which it was searched
      integer, intent(in) :: changed(0:)                !< (0:unknowns) the number of the choice that changed it last
      real(wp), intent(in) :: spent(0:)                 !< (0:blocks) squared distance of all blocks up to this one
      real(wp), intent(in) :: limit                     !< the distance of an assembly
      real(wp) :: square
      integer :: i, j

      do i = size(list), 1, -1
         k = list(i)
         if (found(k)%chosen >= size(found(k)%distance)) cycle
         square = spent(k - 1) + found(k)%distance(found(k)%chosen + 1)**2
         do j = k + 1, size(found)
            if (latest(j) >= k .or. largest_known(b, j, changed) > seen(j)) cycle
            if (size(found(j)%distance) > 0) square = square + min(found(j)%distance(1), found(j)%beyond)**2
         end do
         if (is_nearer(sqrt(square), limit)) return
      end do
      k = 0
   end function last_promising

   !> Finds the positions of a block, for given values of earlier blocks. Newton's method from the guess finds the
   !> first; if all others are further from the goal than the budget, they are not searched for. If there is no
   !> position, found%ending has the closure error that remains, or the cylinder whose length is below 0.
   subroutine find_candidates(b, x, guess, w, s, i, finders, goal, budget, found)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(guess_t), intent(inout) :: guess             !< where Newton's method starts; a start of paths may be added
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s                 !< with the values of earlier blocks; the block's own change
      integer, intent(in) :: i                          !< the number of the block
      integer, intent(in) :: finders(:, :)               !< (2, links) blocks that find angle and position; 0: none
      real(wp), intent(in) :: goal(:, :)                !< (3, links) x and y from the origin of the chain, rad
      real(wp), intent(in) :: budget                    !< a distance: the root of a sum of `squared_distances`
      type(candidates_t), intent(out) :: found          !< the nearest first, none chosen
      type(block_positions_t) :: every
      real(wp), dimension(b%list(i)%shape%n) :: start, least
      real(wp) :: angles
      integer, allocatable :: cylinders_here(:)
      integer :: k

      cylinders_here = pack([(k, k=1, size(x%cylinders))], last_blocks(x, finders) == i)
      allocate (found%x(size(start), 0), found%distance(0))
      start = guess%values(own_unknowns(b, i))
      call set_values(b, i, start, s)
      call solve_block(b, x, i, .true., w, s, found%ending)
      if (is_solved(found%ending)) call record_position(values_of(b, i, s), found%ending%singular)
      if (b%list(i)%explicit) return
      if (size(found%distance) > 0) then
         found%beyond = separation_of(b, x, i, s) - angles
         if (about_equal*found%beyond >= budget) return
         found%beyond = no_distance
      end if

      call find_positions(b, x, i, w, s, max_first_group, guess%starts(i)%paths, every)
      do k = 1, size(every%sign_of)
         call record_position(every%x(:, k), every%sign_of(k) == 0)
      end do
      ! If there is one more, Newton's method has found a position that the enumeration has missed.
      found%are_all = .not. (every%moves .or. every%is_large .or. every%failed > 0) &
         .and. size(found%distance) <= size(every%sign_of)
      if (found%are_all .and. size(found%distance) > 0) return

      call set_values(b, i, start, s)
      call levenberg_marquardt_solve(b, x, i, s)
      least = values_of(b, i, s)
      call solve_block(b, x, i, .true., w, s, found%ending)
      if (is_solved(found%ending)) then
         call record_position(values_of(b, i, s), found%ending%singular)
         if (size(found%distance) == 0) then
            found%ending%ended = ended_elsewhere
            found%ending%open%pair = without_length(x, s, cylinders_here)
         end if
      else
         call set_values(b, i, least, s)
         call find_closure_error(b, x, i, s, found%ending)
      end if

   contains

      !> Inserts a position into `found`, by its distance, unless it is there already or has a cylinder whose length is
      !> not above 0. Its angles are brought within half a turn of the guess; drives between two angles then add whole
      !> turns. Of two positions at equal distances, the one with the greater first value that differs comes first:
      !> rounding shall not choose. `angles` becomes the distance by the angles of the block.
      subroutine record_position(unknowns, is_singular)
         real(wp), intent(in) :: unknowns(:)   !< (unknowns of the block) rad or unit of the loop
         logical, intent(in) :: is_singular    !< the position is singular
         real(wp) :: y(size(unknowns)), square(2, size(finders, 2)), distance
         integer :: k, first

         associate (is_angle => own_unknowns(b, i) <= b%orientations)
            do k = 1, size(found%distance)
               y = found%x(:, k)
               if (all(merge(abs(wrap_angle(unknowns - y)), abs(unknowns - y)/max(1.0_wp, abs(unknowns)), is_angle) &
                  <= merge(same_singular_assembly_tolerance, same_assembly_tolerance, is_singular))) return
            end do
            y = merge(start + wrap_angle(unknowns - start), unknowns, is_angle)
         end associate

         call set_values(b, i, y, s)
         call add_turns(b, x, i, s)
         if (without_length(x, s, cylinders_here) > 0) return
         y = values_of(b, i, s)
         square = squares_of(x, s, goal)
         angles = sqrt(sum(square(1, :), mask=finders(1, :) == i))
         distance = sqrt(sum(square, mask=finders == i))

         do k = 1, size(found%distance)
            if (is_nearer(distance, found%distance(k))) exit
            if (is_nearer(found%distance(k), distance)) cycle
            first = findloc(abs(y - found%x(:, k)) > same_assembly_tolerance, .true., dim=1)
            if (first == 0) cycle
            if (y(first) > found%x(first, k)) exit
         end do
         found%x = reshape([found%x(:, :k - 1), y, found%x(:, k:)], [size(y), size(found%x, 2) + 1])
         found%distance = [found%distance(:k - 1), distance, found%distance(k:)]
      end subroutine record_position
   end subroutine find_candidates

   !> Gives the number of the block (cylinders) after which the length of each cylinder is known; 0: ground links have
   !> both ends.
   pure function last_blocks(x, finders) result(last)
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: finders(:, :)               !< (2, links) blocks that find angle and position; 0: none
      integer :: last(size(x%cylinders)), k

      last = [(maxval(finders(:, [x%cylinders(k)%i, x%cylinders(k)%j])), k=1, size(last))]
   end function last_blocks

   !> Finds the number of the pair of the first cylinder in a list that has no length above 0; 0: all have one.
   function without_length(x, s, list) result(pair)
      type(geometry_t), intent(in) :: x
      type(state_t), intent(in) :: s                    !< with the values of the blocks that move the cylinders
      integer, intent(in) :: list(:)                    !< (any number) numbers of cylinders
      integer :: pair
      type(motion_t) :: q
      logical :: finite
      integer :: k

      pair = 0
      if (size(list) == 0) return
      q = new_motion(size(x%equations%axes%angle_offset))
      call move_links(x%chain, size(x%chain%links), s, q, finite)
      do k = 1, size(list)
         associate (one => x%cylinders(list(k)))
            if (cylinder_length(one, q%position(:, one%i), q%position(:, one%j)) > 0.0_wp) cycle
            pair = one%pair
            return
         end associate
      end do
   end function without_length

   !> Gives for each link (2, links) the number of the block that finds its angle, and of the block after which its
   !> position is known; 0: none, for ground links.
   pure function places_of(b, x) result(finders)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer :: finders(2, size(b%tree%orientation)), block_of(0:b%unknowns), k

      block_of(0) = 0
      block_of(1:) = b%block_of
      finders = 0
      do k = 1, size(x%chain%links)
         associate (h => x%chain%links(k))
            finders(1, h%link) = block_of(h%orientation)
            finders(2, h%link) = max(block_of(h%orientation), block_of(h%slide))
            if (h%parent > 0) finders(2, h%link) = max(finders(2, h%link), finders(2, h%parent))
            if (h%root > 0) finders(2, h%link) = max(finders(2, h%link), block_of(h%root), block_of(h%root + 1))
         end associate
      end do
   end function places_of

   !> Tells whether a distance is less than another one by more than rounding, which leaves half of all digits of nearly
   !> singular positions.
   elemental logical function is_nearer(one, other) result(is)
      real(wp), intent(in) :: one, other                !< distances: roots of `squared_distances`

      is = one < other - equal_distance_part*max(other, max_position_offset)
   end function is_nearer

   !> Measures how far the links of a state are from a goal (2, links): the square of the angle, in rad, and of the
   !> distance, in characteristic lengths.
   function squares_of(x, s, goal) result(square)
      type(geometry_t), intent(in) :: x
      type(state_t), intent(in) :: s                    !< with the values of all unknowns
      real(wp), intent(in) :: goal(:, :)                !< (3, links) x and y from the origin of the chain, rad
      real(wp) :: square(2, size(goal, 2))
      type(motion_t) :: q
      logical :: finite

      q = new_motion(size(goal, 2))
      call move_links(x%chain, size(x%chain%links), s, q, finite)
      square = squared_distances(q%position, goal, x%span)
   end function squares_of

   !> Gives the distance of an assembly from a goal, sqrt(sum(`squared_distances`)) over all links that a block moves.
   real(wp) function distance_of(x, s, finders, goal) result(distance)
      type(geometry_t), intent(in) :: x
      type(state_t), intent(in) :: s                    !< with the assembly
      integer, intent(in) :: finders(:, :)               !< (2, links) blocks that find angle and position; 0: none
      real(wp), intent(in) :: goal(:, :)                !< (3, links) x and y from the origin of the chain, rad

      distance = sqrt(sum(squares_of(x, s, goal), mask=finders > 0))
   end function distance_of

   !> Measures how far each link is from its guess (2, links): the square of the angle, in rad, and of the distance, in
   !> lengths of `span`, of which `max_position_offset` counts at most.
   pure function squared_distances(position, guess, span) result(square)
      real(wp), intent(in) :: position(:, :)            !< (3, links) x, y, from the origin of `guess`, and rad
      real(wp), intent(in) :: guess(:, :)               !< (3, links) x, y and rad
      real(wp), intent(in) :: span                      !< characteristic length, in the unit of x and y
      real(wp) :: square(2, size(position, 2))

      square(1, :) = wrap_angle(position(3, :) - guess(3, :))**2
      square(2, :) = min(sum(((position(:2, :) - guess(:2, :))/span)**2, dim=1), max_position_offset**2)
   end function squared_distances

   !> Bounds from below how far any other position of a block is from its position in `s`: some angle differs by the
   !> bound, in rad. With the Jacobian J and its Lipschitz constant L the bound is 2/(|J^-1| L), by Newton and
   !> Kantorovich; 0 at a singular position. With more than two unknowns |J^-1| may be estimated, too small by a factor
   !> up to their number n: n is put in. Long slides make L larger.
   pure real(wp) function separation_of(b, x, i, s) result(separation)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i                          !< the number of the block
      type(state_t), intent(in) :: s                    !< with the position, and the findings of its Jacobian
      real(wp) :: bound
      integer :: m, k

      separation = 0.0_wp
      if (s%is_singular(i)) return
      bound = 1.0_wp
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         do k = b%loops(m)%first_slide, b%loops(m)%last_slide
            bound = max(bound, 1.0_wp + 0.5_wp*abs(s%u(b%slides(k)%unknown)%value))
         end do
      end do
      bound = bound*x%blocks(i)%lipschitz*s%jacobian(i)%inverse
      if (b%list(i)%shape%n > 2) bound = bound*real(b%list(i)%shape%n, wp)
      separation = 2.0_wp/max(bound, tiny(bound))
   end function separation_of
end module initial_assembly
