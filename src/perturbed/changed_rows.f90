!> Rows of a mechanism whose numbers are changed, solved from a position of the unchanged mechanism by Newton's method,
!> block by block: never by a run of its own, which could take the other branch near a change point.
module changed_rows
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use motion, only: motion_t, turned_t, new_motion, forget_links
   use points, only: row_t, find_row
   use blocks, only: blocks_t, geometry_t, largest_known, own_unknowns
   use block_state, only: unknown_t, state_t, new_state, set_drive_values
   use block_solver, only: workspace_t, new_workspace, solve_block
   use block_matrix, only: solve_first, solve_again
   use block_equations, only: assemble_dense, right_hand_side
   use block_structure, only: structure_t, make_structure
   use drive_path, only: drive_path_t
   use block_motion, only: select_solved_blocks, assign_geometry, assign_path, get_ratios
   use convergence, only: solve_report_t, is_solved, ended_inconsistent
   use rounded_numbers, only: directions, own_directions
   use link_motion, only: move_links, flag_links, missing_nothing, missing_rates, missing_all
   implicit none
   private
   public :: perturbed_t, base_position_t, find_place, make_ready, assign_changes, rows_with

   !> A mechanism with changed numbers: another geometry of one structure.
   type :: perturbed_t
      type(mechanism_t) :: m                     !< with the changed numbers
      type(geometry_t) :: geometry               !< by these numbers
      type(drive_path_t) :: path                 !< of its drives
      logical :: is_ready = .false.              !< it was made for the mechanism that is estimated
      logical :: fits = .true.                   !< the structure serves for its numbers
      integer :: direction = -1                  !< numbers are off by `roundings` in this direction; -1: other numbers
      real(wp) :: roundings = 0.0_wp             !< how many; below 0: in the opposite direction
      real(wp) :: time_off = 0.0_wp              !< the instant is off by this part of its time
      real(wp) :: length = 0.0_wp                !< size that counts for all lengths, deck's unit; 0: each its own
   end type perturbed_t

   !> A position from which rows of changed mechanisms are solved, state and workspace for it, and the findings of the
   !> last solution.
   type :: base_position_t
      type(unknown_t), allocatable :: start(:)   !< (0:unknowns) of the unchanged mechanism, slides in the deck's unit
      logical :: only_driven = .false.           !< only links that only drives move are known
      logical :: is_singular = .false.           !< it has no unique rates
      logical :: stays = .false.                 !< a search begins at the position itself, without a shift
      type(turned_t), allocatable :: turned(:)   !< (measures) angles from which measures continue
      type(state_t) :: state                     !< of the last solution
      type(workspace_t) :: work                  !< scratch of the solver
      type(motion_t) :: q                        !< of the last solution, in the deck's units
      !> The largest Kantorovich ratio of a block: the change of its position over the distance of the next position.
      real(wp) :: ratio = 0.0_wp
      real(wp) :: change = 0.0_wp                !< the largest change of an unknown, rad or unit of the block
      logical :: jams = .false.                  !< equations contradict one another
      !> Redundant equations: the largest closure error (unit of the loop, or rad) over its `level`, and its bound.
      real(wp) :: opened = 0.0_wp, room = huge(1.0_wp)
   end type base_position_t

   !> Up to so many links, the changed mechanisms of all directions are kept from instant to instant. For a larger
   !> mechanism one changed mechanism is kept, which takes less memory.
   integer, parameter :: kept_links = 1000
   !> A search begins this far (rad, unit of the block) from the position: at the position itself it would end at once,
   !> and show nothing of the residual that is left. On a dead point it begins as far away as roundings may have moved
   !> the position.
   real(wp), parameter :: start_shift = sqrt(epsilon(1.0_wp))/1024.0_wp, singular_shift = 16.0_wp*sqrt(epsilon(1.0_wp))
   !> A change with a larger Kantorovich ratio is not of first order: its rows count as unknown.
   real(wp), parameter :: first_order_ratio = 0.5_wp
   !> At a dead point a position moves by the root of a change of numbers (rad, unit of the block). A search that goes
   !> farther has found no position, and ends anywhere.
   real(wp), parameter :: singular_change = 4096.0_wp*sqrt(epsilon(1.0_wp))

contains

   !> Makes a motion the position from which rows are solved from now on.
   subroutine find_place(b, x, s, q, base)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(state_t), intent(in) :: s         !< of the motion
      type(motion_t), intent(in) :: q        !< the motion, of the unchanged mechanism
      type(base_position_t), intent(inout) :: base   !< the position, the motion before included
      integer :: k

      base%only_driven = q%known < 0
      base%is_singular = q%known == 0
      if (allocated(q%turned)) base%turned = q%turned
      if (.not. allocated(base%start)) then
         allocate (base%start(0:b%unknowns))
         call make_room(b, ubound(s%drive_value, 2), base)
         base%q = new_motion(size(q%position, 2))
         base%q%known = 2
      end if
      base%start(:) = s%u
      do k = 1, ubound(base%start, 1)
         base%start(k)%value = base%start(k)%value*slide_unit(b, x, k)
      end do
   end subroutine find_place

   !> Makes state and workspace of a base position for a structure.
   subroutine make_room(b, drives, base)
      type(blocks_t), intent(in) :: b        !< the structure
      integer, intent(in) :: drives          !< how many drives there are
      type(base_position_t), intent(inout) :: base   !< state and work are set

      base%state = new_state(b, drives)
      base%work = new_workspace(b)
   end subroutine make_room

   !> Finds the changed mechanism of a direction. If it is not ready, it becomes a copy of the unchanged mechanism;
   !> otherwise it keeps its numbers, which may belong to another direction.
   subroutine make_ready(list, k, m, x, i)
      type(perturbed_t), allocatable, intent(inout) :: list(:)   !< (0:directions) or (0:0); made if not allocated
      integer, intent(in) :: k               !< the direction; 0: numbers as they stand
      type(mechanism_t), intent(in) :: m     !< the unchanged mechanism
      type(geometry_t), intent(in) :: x      !< the geometry of the unchanged mechanism
      integer, intent(out) :: i              !< the index of the changed mechanism in `list`

      if (.not. allocated(list)) allocate (list(0:merge(directions + own_directions, 0, size(m%links) <= kept_links)))
      i = merge(k, 0, k <= ubound(list, 1))
      associate (p => list(i))
         if (p%is_ready) return
         p%is_ready = .true.
         p%direction = -1
         p%m = m
         p%geometry = x
      end associate
   end subroutine make_ready

   !> Gives geometry and path of a changed mechanism the numbers of its cards. If these are off by roundings only, terms
   !> that cancel in the equations are left out: redundant equations stay redundant, and parallel guides stay parallel.
   subroutine assign_changes(b, perturbed, by_roundings)
      type(blocks_t), intent(in) :: b
      type(perturbed_t), intent(inout) :: perturbed   !< its `m` has the numbers; `fits` is set
      logical, intent(in) :: by_roundings    !< the numbers are off by roundings only: they fit

      perturbed%m%tolerance = 0.0_wp
      call assign_geometry(perturbed%m, b, perturbed%geometry, perturbed%path, perturbed%fits)
      perturbed%fits = perturbed%fits .or. by_roundings
   end subroutine assign_changes

   !> Finds the rows of a changed mechanism near a position. If its numbers do not fit the structure, it is solved by a
   !> structure of its own; if that has other redundant equations, it jams.
   subroutine rows_with(b, perturbed, t, base, rows)
      type(blocks_t), intent(in) :: b        !< the structure of the unchanged mechanism
      type(perturbed_t), intent(in) :: perturbed   !< with geometry and path
      real(wp), intent(in) :: t              !< time, in the deck's unit
      type(base_position_t), intent(inout) :: base   !< the position; then also the findings of the solution
      type(row_t), intent(inout) :: rows(:)  !< (requests) `known` of a row tells how much of it was found
      type(structure_t) :: other
      type(drive_path_t) :: path
      integer :: i

      base%q%t = t
      if (perturbed%fits) then
         call solve_needed(b, perturbed%geometry, perturbed%path, base)
      else
         call make_structure(perturbed%m, other)
         call select_solved_blocks(perturbed%m, other%blocks, other%geometry)
         call assign_path(perturbed%m, other%blocks, other%geometry, path)
         if (other%blocks%solvable) call make_room(other%blocks, size(path%laws), base)
         call solve_needed(other%blocks, other%geometry, path, base)
         call make_room(b, size(path%laws), base)
         if (.not. other%blocks%solvable .or. other%blocks%redundant /= b%redundant) then
            base%jams = .true.
            base%q%link_known = spread(-1, 1, size(perturbed%m%links))
         end if
      end if

      if (allocated(base%turned)) base%q%turned = base%turned
      do i = 1, size(rows)
         call find_row(perturbed%m, base%q, perturbed%m%requests(i), rows(i))
      end do
   end subroutine rows_with

   !> Solves the needed blocks of a changed mechanism in turn, from a base position, and finds the motion of its links.
   !> Blocks without a position, or whose change is not of first order, leave the links that they move flagged. If the
   !> structure is not solvable, nothing is solved.
   subroutine solve_needed(b, x, path, base)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x      !< of the changed mechanism
      type(drive_path_t), intent(in) :: path   !< of the changed mechanism
      type(base_position_t), intent(inout) :: base   !< with the time base%q%t; then the motion and the findings
      type(solve_report_t) :: c
      integer :: missing(0:ubound(base%start, 1)), k, lost, worst
      logical :: finite

      base%ratio = 0.0_wp
      base%change = 0.0_wp
      base%jams = .false.
      base%opened = 0.0_wp
      if (.not. b%solvable) return
      associate (s => base%state, w => base%work, q => base%q)
         s%u(:) = base%start
         do k = 1, ubound(s%u, 1)
            associate (value => s%u(k)%value)
               value = value/slide_unit(b, x, k)
               ! On a dead point the Jacobian has an inverse only if links that are in line turn apart.
               if (.not. base%stays) value = value + merge(singular_shift*(-1)**k, start_shift, base%is_singular)
            end associate
         end do
         call set_drive_values(path, q%t, s)

         missing = missing_nothing
         worst = missing_nothing
         do k = 1, size(b%needed)
            associate (i => b%needed(k), block => b%list(b%needed(k)))
               lost = missing_nothing
               if (worst > missing_nothing) lost = largest_known(b, i, missing)
               if (base%only_driven .and. .not. block%explicit) lost = missing_all
               if (lost < missing_all) then
                  call solve_block(b, x, i, .true., w, s, c)

                  base%ratio = max(base%ratio, c%kantorovich_ratio)
                  ! A position out of reach contradicts nothing: a smaller change may find one.
                  if (is_solved(c) .or. c%ended == ended_inconsistent) &
                     base%opened = max(base%opened, c%open%value/c%open%level)
                  base%jams = base%jams .or. c%ended == ended_inconsistent .or. c%rates_inconsistent &
                     .or. base%opened > base%room

                  if (c%singular) lost = missing_rates
                  if (.not. is_solved(c) .or. c%rates_inconsistent) lost = missing_all
                  if (block%shape%rows > block%shape%n .and. lost < missing_rates) call refine_rates(b, x, i, w, s)
                  if (base%is_singular) then
                     if (c%change > singular_change) lost = missing_all
                  else if (c%kantorovich_ratio > first_order_ratio .and. .not. c%singular) then
                     lost = missing_all
                  end if
               end if
               worst = max(worst, lost)
               if (lost > missing_nothing) missing(b%unknown(block%first:block%last)) = lost
            end associate
         end do

         ! The changes of explicit unknowns count too: a drive that makes full turns does not return.
         do k = 1, ubound(s%u, 1)
            base%change = max(base%change, abs(s%u(k)%value - base%start(k)%value/slide_unit(b, x, k)))
         end do
         call move_links(x%chain, x%chain%wanted, s, q, finite)
         if (size(b%ratios) > 0) call get_ratios(b, x, path, [(missing(b%unknown(max(1, b%list(k)%first))) &
            > missing_nothing, k=1, size(b%list))], s, w, q)
         call forget_links(q)
         if (worst > missing_nothing) call flag_links(x%chain, missing, q)
      end associate
   end subroutine solve_needed

   !> Improves rates and accelerations of a block with redundant equations by iterative refinement. Reason: the
   !> orthogonal factors leave errors as large as the largest of all rows; one pass reduces the error of each row to
   !> its own size (Higham, Accuracy and Stability of Numerical Algorithms, 2002, ch. 20). With a singular Jacobian
   !> they stay.
   subroutine refine_rates(b, x, i, w, s)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< number of the block
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s      !< with the motion of the block
      real(wp), allocatable :: jacobian(:, :)
      integer :: order, info

      associate (shape => b%list(i)%shape, own => own_unknowns(b, i))
         call assemble_dense(b, x, i, s, w%a, w%r)
         jacobian = reshape(w%a(:shape%rows*shape%n), [shape%rows, shape%n])
         call solve_first(shape, w%a, w%pivots, w%work, w%r, info)
         if (info > 0) return
         do order = 1, 2
            call right_hand_side(b, x, i, order, s, w%r)
            w%r(:shape%rows) = w%r(:shape%rows) &
               - matmul(jacobian, merge(s%u(own)%rate, s%u(own)%acceleration, order == 1))
            call solve_again(shape, w%a, w%pivots, w%work, w%r)
            if (order == 1) s%u(own)%rate = s%u(own)%rate + w%r(:shape%n)
            if (order == 2) s%u(own)%acceleration = s%u(own)%acceleration + w%r(:shape%n)
         end do
      end associate
   end subroutine refine_rates

   !> Gives the unit of an unknown: of a slide in the deck's unit of length; 1 of an angle.
   pure real(wp) function slide_unit(b, x, k) result(unit)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: k               !< the number of the unknown

      unit = x%unit(k)
      if (k > b%orientations) unit = unit*x%equations%length
   end function slide_unit
end module changed_rows
