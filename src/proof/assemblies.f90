!> All assemblies of a mechanism at one instant: a tree, in which each assembly of earlier blocks gives the next block
!> its equations. A block is solved again only if a block on which it builds has changed. Each assembly is proved.
!> If all assemblies are known, a run begins in the assembly that is nearest to the deck's estimate.
module assemblies
   use kinds, only: wp
   use plane_vectors, only: wrap_angle
   use mechanism, only: mechanism_t, plane_origin
   use cylinders, only: cylinder_length, is_out_of_stroke
   use separations, only: separation
   use motion, only: motion_t, new_motion
   use convergence, only: is_solved
   use block_state, only: set_drive_values
   use continuation, only: continuation_t, begin_continuation, solve_at
   use initial_assembly, only: places_of, squared_distances, is_nearer, same_position => same_assembly_tolerance
   use blocks, only: largest_known, own_unknowns
   use block_state, only: set_values
   use link_motion, only: move_links
   use ball_equations, only: ball_numbers_t
   use ball_numbers, only: new_ball_numbers
   use balls, only: ball_t
   use link_bounds, only: bound_links
   use position_proof, only: proved_position_t, new_placed, prove_position
   use block_assemblies, only: block_positions_t, find_positions, max_group
   implicit none
   private
   public :: assembly_t, assembly_block_t, assemblies_t, find_assemblies, find_nearest, max_assemblies

   !> A search ends after so many assemblies: ten blocks with two positions each have more.
   integer, parameter :: max_assemblies = 1000
   !> Assemblies whose distances differ by less than this part stay in the order in which they are found.
   real(wp), parameter :: same_distance_part = sqrt(epsilon(1.0_wp))
   !> A cylinder shorter than this part of the characteristic length may have the length 0: the deck's digits leave so
   !> much uncertain.
   real(wp), parameter :: zero_length = max(1.0e-10_wp, 64.0_wp*epsilon(1.0_wp))

   !> An assembly.
   type :: assembly_t
      real(wp), allocatable :: position(:, :)   !< (3, links) x, y in the deck's unit from `plane_origin`, phi in rad
      integer, allocatable :: sign_of(:)        !< (blocks) of the determinant; 0: singular
      logical :: is_proved = .false.            !< it is proved that near it there is exactly one solution
      logical :: is_out = .false.               !< a cylinder is out of its stroke
      real(wp) :: distance = 0.0_wp             !< from the deck's estimate: the root of the sum of `squared_distances`
   end type assembly_t

   !> The findings of a block that is not explicit, in all assemblies of the blocks on which it builds.
   type, extends(block_positions_t) :: assembly_block_t
      integer :: block = 0                      !< the number of the block
      !> Numbers of the links whose angles are its unknowns; if all its unknowns are slides, of the links whose position
      !> is known after this block and not before.
      integer, allocatable :: links(:)
      integer :: unknowns = 0                   !< how many unknowns the block has
      logical :: is_redundant = .false.         !< more equations than unknowns: no determinant
   end type assembly_block_t

   !> All assemblies that were found.
   type :: assemblies_t
      type(assembly_t), allocatable :: list(:)         !< the nearest to the estimate first
      type(assembly_block_t), allocatable :: blocks(:) !< the blocks that are not explicit, in solving order
      logical :: are_more = .false.                    !< the search ended at `max_assemblies`
      integer :: chosen = 0                            !< number of the assembly in which a run begins; 0: in none
      integer :: negative = 0                          !< how many have a cylinder of negative length: not listed
      logical :: is_missed = .false.                   !< a run begins at a position that is none of these assemblies
      logical :: is_known = .true.                     !< no other assembly exists, but for blocks that can move
   end type assemblies_t

contains

   !> Finds all assemblies of a mechanism at a time; none if its structure is not solvable. It is not found in which of
   !> them a run begins.
   subroutine find_assemblies(m, t, assemblies)
      type(mechanism_t), intent(in) :: m     !< one independent mechanism
      real(wp), intent(in) :: t              !< time, in the deck's unit
      type(assemblies_t), intent(out) :: assemblies   !< all that were found
      type(continuation_t) :: f
      type(assembly_block_t) :: one
      integer :: i, k, finders(2, size(m%links))

      allocate (assemblies%list(0), assemblies%blocks(0))
      call begin_continuation(f, m)
      if (.not. f%blocks%solvable) return
      call set_drive_values(f%path, t, f%state)
      finders = places_of(f%blocks, f%geometry)
      do i = 1, size(f%blocks%list)
         associate (shape => f%blocks%list(i)%shape)
            if (f%blocks%list(i)%explicit .or. shape%n == 0) cycle
            one%block = i
            one%unknowns = shape%n
            one%is_redundant = shape%rows > shape%n
         end associate
         one%links = pack([(k, k=1, size(m%links))], finders(1, :) == i)
         if (size(one%links) == 0) one%links = pack([(k, k=1, size(m%links))], finders(2, :) == i)
         assemblies%blocks = [assemblies%blocks, one]
      end do
      call search(m, f, assemblies)
      assemblies%is_known = .not. (assemblies%are_more &
         .or. any(assemblies%blocks%is_large .or. assemblies%blocks%failed > 0))
   end subroutine find_assemblies

   !> Finds all assemblies of a mechanism, and the assembly in which a run begins. A run from the deck's estimate leads
   !> to it, unless all assemblies are known and another one is nearer, or the run leads to a position that can move.
   !> Then the nearest assembly becomes the estimate. If the run leads to a position that is none of the assemblies,
   !> some may be missing.
   subroutine find_nearest(m, t, assemblies)
      type(mechanism_t), intent(inout) :: m  !< one independent mechanism; the estimates of its links may change
      real(wp), intent(in) :: t              !< time, in the deck's unit
      type(assemblies_t), intent(out) :: assemblies   !< all that were found
      type(continuation_t) :: f
      type(motion_t) :: q
      real(wp) :: apart, nearest
      logical :: unused, is_found
      integer :: i

      call find_assemblies(m, t, assemblies)
      call begin_continuation(f, m)
      call solve_at(f, t)
      is_found = is_solved(f%convergence)
      if (is_found) then
         q = new_motion(size(m%links))
         call move_links(f%geometry%chain, size(f%geometry%chain%links), f%state, q, unused)
         ! Of all assemblies that are near enough the nearest counts, without whole turns.
         nearest = same_position
         do i = 1, size(assemblies%list)
            apart = maxval(separation(assemblies%list(i)%position, q%position, f%geometry%span))
            if (apart > nearest) cycle
            nearest = apart
            assemblies%chosen = i
         end do
      end if

      if (is_nearer_one()) then
         assemblies%chosen = 1
         do i = 1, size(m%links)
            if (m%links(i)%ground) cycle
            associate (estimate => m%links(i)%position, found => assemblies%list(1)%position(:, i))
               estimate = [found(:2) + plane_origin(m), estimate(3) + wrap_angle(found(3) - estimate(3))]
            end associate
         end do
      end if
      assemblies%is_missed = is_found .and. assemblies%chosen == 0
      assemblies%is_known = assemblies%is_known .and. .not. assemblies%is_missed

   contains

      !> Tells whether all assemblies are known, and the first of the list is nearer than the position to which a run
      !> from the estimate leads.
      logical function is_nearer_one() result(is)
         is = size(assemblies%list) > 0 .and. assemblies%is_known
         if (is) is = assemblies%list(1)%is_proved
         if (.not. is) return
         if (assemblies%chosen == 0) then
            is = .not. is_found .or. any(assemblies%blocks%moves)
         else
            associate (distance => assemblies%list(assemblies%chosen)%distance)
               is = is_nearer(assemblies%list(1)%distance, distance)
            end associate
         end if
      end function is_nearer_one
   end subroutine find_nearest

   !> Finds all assemblies by going through all choices of a position for each block, depth first.
   subroutine search(m, continuation, assemblies)
      type(mechanism_t), intent(in) :: m
      type(continuation_t), intent(inout) :: continuation   !< of `m`, with the drives; state and needed blocks change
      type(assemblies_t), intent(inout) :: assemblies   !< with its blocks; assemblies and findings of blocks are added
      type(block_positions_t) :: found(size(continuation%blocks%list))
      type(ball_numbers_t) :: p
      type(proved_position_t) :: q
      ! (blocks) chosen: the number of its position; seen: the number of the last choice before its positions were
      ! found. (0:unknowns) changed: the number of the last choice that changed it.
      integer :: chosen(size(found)), seen(size(found)), changed(0:continuation%blocks%unknowns), choice, failed, i, k
      logical :: is_proved

      p = new_ball_numbers(m, continuation%blocks, continuation%geometry)
      q = new_placed(continuation%blocks, size(m%drives))
      continuation%blocks%needed = [(k, k=1, size(found))]
      chosen = 0
      seen = -1
      changed = 0
      choice = 0
      i = 1

      do while (i >= 1)
         if (i > size(found)) then
            assemblies%are_more = size(assemblies%list) == max_assemblies
            if (assemblies%are_more) exit
            call prove_position(p, continuation%blocks, continuation%path, continuation%state, 0, q, failed)
            is_proved = failed == 0 .and. .not. any([(found(k)%rates_inconsistent(chosen(k)), k=1, size(found))])
            call record_assembly(continuation, found, chosen, is_proved, p, q, assemblies)
            i = i - 1
            cycle
         end if

         if (chosen(i) == 0 .and. largest_known(continuation%blocks, i, changed) > seen(i)) then
            call find_positions(continuation%blocks, continuation%geometry, i, continuation%work, continuation%state, &
               max_group, continuation%guess%starts(i)%paths, found(i))
            seen(i) = choice
         end if

         chosen(i) = chosen(i) + 1
         if (chosen(i) > size(found(i)%sign_of)) then
            chosen(i) = 0
            i = i - 1
            cycle
         end if
         call set_values(continuation%blocks, i, found(i)%x(:, chosen(i)), continuation%state)
         choice = choice + 1
         changed(own_unknowns(continuation%blocks, i)) = choice
         i = i + 1
      end do

      do k = 1, size(assemblies%blocks)
         assemblies%blocks(k)%block_positions_t = found(assemblies%blocks(k)%block)
      end do
   end subroutine search

   !> Inserts an assembly into the list, the nearest first. At equal distances the assembly found first comes first. An
   !> assembly with a cylinder of negative length is only counted.
   subroutine record_assembly(continuation, found, chosen, is_proved, numbers, proof, assemblies)
      type(continuation_t), intent(in) :: continuation   !< its state is the assembly
      type(block_positions_t), intent(in) :: found(:)   !< (blocks) all positions for the positions of earlier blocks
      integer, intent(in) :: chosen(:)       !< (blocks) numbers of the positions of the assembly
      logical, intent(in) :: is_proved       !< the assembly is proved
      type(ball_numbers_t), intent(in) :: numbers     !< the geometry in balls
      type(proved_position_t), intent(in) :: proof    !< if proved: the balls that hold the assembly
      type(assemblies_t), intent(inout) :: assemblies   !< one more, or one more counted as negative
      type(assembly_t) :: one
      type(motion_t) :: q
      type(ball_t) :: links(3, 0:2, size(continuation%guess%links, 2))
      real(wp) :: length, zero, off(2, 0:2)
      logical :: finite
      integer :: i, k

      q = new_motion(size(continuation%guess%links, 2))
      call move_links(continuation%geometry%chain, size(continuation%geometry%chain%links), continuation%state, q, &
         finite)
      one%is_proved = is_proved
      off = 0.0_wp
      if (is_proved) call bound_links(continuation%geometry, numbers, proof%ball_state_t, q, links, off)
      do i = 1, size(continuation%geometry%cylinders)
         associate (c => continuation%geometry%cylinders(i))
            length = cylinder_length(c, q%position(:, c%i), q%position(:, c%j))
            ! An assembly with a length that may be 0 is listed, but not proved: the sign of the length is unknown.
            zero = max(zero_length*continuation%geometry%span, &
               3.0_wp*off(1, 0) + off(2, 0)*(norm2(c%p) + norm2(c%q) + abs(length)))
            if (abs(length) <= zero) one%is_proved = .false.
            one%is_out = one%is_out .or. is_out_of_stroke(c%stroke, max(length, 0.0_wp))
         end associate
         if (length < -zero) assemblies%negative = assemblies%negative + 1
         if (length < -zero) return
      end do

      one%position = q%position
      one%sign_of = [(found(i)%sign_of(chosen(i)), i=1, size(found))]
      one%distance = sqrt(sum(squared_distances(one%position, continuation%guess%links, continuation%geometry%span)))
      k = count(assemblies%list%distance <= one%distance*(1.0_wp + same_distance_part))
      assemblies%list = [assemblies%list(:k), one, assemblies%list(k + 1:)]
   end subroutine record_assembly
end module assemblies
