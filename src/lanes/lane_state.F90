!> The motions of several mechanisms of one structure, each in a lane: `state_t` and `history_t` as arrays whose first
!> index is the lane. A lane takes over from a mechanism whose last three motions are at equal steps. It gives back the
!> motion of its last instant.
#define NUMBER real(wp), dimension(lane_count)
#define IS(value)
module lane_state
   use kinds, only: wp
   use mechanism, only: own_predictor
   use drive_path, only: drive_path_t
   use blocks, only: blocks_t
   use continuation, only: continuation_t
   use lane_sines, only: lane_count
   use lane_elimination, only: max_order
   implicit none
   private
   public :: lanes_t, lane_block_t, is_covered, make_lanes, load_lane, unload_lane, depth
   public :: vector_t, unknown_t, row_numbers_t, loop_numbers_t, loop_state_t

   ! The parts of equations, one number a lane.
#include "number_types.inc"

   !> Motions that a lane has room for: the last three, for a prediction, and the next.
   integer, parameter :: depth = 4

   !> A block in each lane. `lipschitz` bounds the change of its Jacobian over the change of its unknowns. Values count
   !> as `coarse` at least. `sign_of` is the sign of the determinant at the latest motion.
   type :: lane_block_t
      real(wp), dimension(lane_count) :: lipschitz = 0.0_wp, coarse = 1.0_wp, sign_of = 1.0_wp
      logical :: has_right_sides = .false.              !< in any lane some of its equations are not = 0
      real(wp), dimension(lane_count, 0:depth - 1) :: pivot = 1.0_wp, inverse = 1.0_wp   !< as in `jacobian_t`, by slots
   end type lane_block_t

   !> The lanes of the variants of one set. Lengths of each lane are in the unit of its own analysis. Numbers of the
   !> kind `wp` in `blocks` do not count.
   type :: lanes_t
      type(blocks_t) :: blocks                          !< the structure that all lanes have
      !> Numbers of the blocks that are solved at every step, and of the unknowns that are iterated.
      integer, allocatable :: moving(:), predicted(:)
      logical :: is_polynomial = .true.                 !< the laws have no terms
      type(drive_path_t) :: path(lane_count)                 !< of the drives; its units are as `unit`
      real(wp), allocatable :: polynomial(:, :, :)      !< (lanes, 3, drives) at t = 0: value, rate, acceleration
      real(wp), allocatable :: unit(:, :)               !< (lanes, drives) factor of the drives' values in the equations
      real(wp), allocatable :: drive(:, :, :)           !< (lanes, 0:2, 0:drives) found last
      real(wp) :: t(lane_count, 0:depth - 1) = 0.0_wp        !< times, by slots
      real(wp) :: excursion(lane_count) = 0.0_wp             !< of the drives in a step, characteristic lengths or rad
      integer :: slot(0:depth - 1) = [0, 1, 2, 3]       !< of the motions, the latest first
      type(unknown_t), allocatable :: u(:)              !< (0:unknowns) found last
      !> (lanes, value and rate and acceleration, slots, unknowns) that are remembered
      real(wp), allocatable :: past(:, :, :, :)
      type(lane_block_t), allocatable :: block(:)       !< (blocks)
      ! Numbers and state, as in `geometry_t` and `state_t`.
      type(row_numbers_t), allocatable :: rows(:)       !< (rows)
      type(loop_numbers_t), allocatable :: numbers(:)   !< (loops)
      type(vector_t), allocatable :: d(:), e(:)         !< (body vectors), (slides) in their axes
      type(vector_t), allocatable :: own(:), guide(:)   !< (body vectors), (slides) rotated by angles of the block
      type(loop_state_t), allocatable :: loop(:)        !< (loops)
   end type lanes_t

contains

   !> Tells whether the lanes can take over from a mechanism: reals are double, its blocks have at most `max_order`
   !> unknowns, as many as equations, three motions are known, and no card sets a tolerance. The caller checks that the
   !> steps between the motions are equal.
   pure logical function is_covered(continuation)
      type(continuation_t), intent(in) :: continuation   !< of the mechanism, at its last instant
      integer :: k

      is_covered = digits(1.0_wp) == 53 .and. continuation%blocks%redundant == 0 &
         .and. size(continuation%history%predicted) > 0
      if (.not. is_covered) return
      is_covered = continuation%history%filled == 3 .and. continuation%history%order == own_predictor &
         .and. .not. continuation%geometry%tolerance > 0.0_wp
      do k = 1, size(continuation%blocks%moving)
         associate (shape => continuation%blocks%list(continuation%blocks%moving(k))%shape)
            is_covered = is_covered .and. shape%n <= max_order .and. shape%rows == shape%n .and. shape%pattern == 0
         end associate
      end do
   end function is_covered

   !> Makes lanes for mechanisms of one structure.
   subroutine make_lanes(lanes, continuation)
      type(lanes_t), intent(out) :: lanes    !< without a motion
      type(continuation_t), intent(in) :: continuation   !< one of the mechanisms

      lanes%blocks = continuation%blocks
      lanes%moving = continuation%blocks%moving
      lanes%predicted = continuation%history%predicted
      associate (b => lanes%blocks, drives => size(continuation%path%laws))
         allocate (lanes%polynomial(lane_count, 3, drives), lanes%unit(lane_count, drives))
         allocate (lanes%drive(lane_count, 0:2, 0:drives), source=0.0_wp)
         allocate (lanes%block(size(b%list)))
         allocate (lanes%past(lane_count, 3, 0:depth - 1, 0:b%unknowns), source=0.0_wp)
         allocate (lanes%u(0:b%unknowns), source=unknown_t(0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp))
         associate (none => vector_t(0.0_wp, 0.0_wp))
            allocate (lanes%rows(size(b%rows)), source=row_numbers_t(0.0_wp, 1.0_wp))
            allocate (lanes%numbers(size(b%loops)), source=loop_numbers_t(none, none, 1.0_wp, 1.0_wp))
            allocate (lanes%d(size(b%body_vectors)), lanes%own(size(b%body_vectors)), lanes%e(size(b%slides)), &
               lanes%guide(size(b%slides)), source=none)
            allocate (lanes%loop(size(b%loops)), source=loop_state_t(none, none, none))
         end associate
      end associate
   end subroutine make_lanes

   !> Fills a lane with the mechanism and the motions of a variant. The caller sets lanes%excursion, which depends on
   !> the step. If the variant's numbers put other body vectors or slides into the equations, the lane stays as it was.
   subroutine load_lane(lanes, lane, continuation, is_alike)
      type(lanes_t), intent(inout) :: lanes   !< by `make_lanes`
      integer, intent(in) :: lane            !< the number of the lane
      type(continuation_t), intent(in) :: continuation   !< a variant of the mechanism for which the lanes were made
      logical, intent(out) :: is_alike       !< the equations have the lanes' body vectors and slides
      integer :: i, k

      associate (a => lanes%blocks%equations, b => continuation%blocks%equations)
         ! Equations that cannot be solved have no vectors.
         is_alike = a%count == b%count
         if (is_alike) is_alike = all(a%has_vector .eqv. b%has_vector) .and. all(a%counts .eqv. b%counts)
      end associate
      if (.not. is_alike) return

      lanes%path(lane) = continuation%path
      lanes%is_polynomial = .true.
      do i = 1, size(continuation%path%laws)
         associate (law => continuation%path%laws(i))
            lanes%polynomial(lane, :, i) = law%polynomial
            lanes%is_polynomial = lanes%is_polynomial .and. .not. allocated(law%terms)
         end associate
         lanes%unit(lane, i) = continuation%path%unit(i)
      end do
      associate (x => continuation%geometry, u => continuation%state%u)
         lanes%block%lipschitz(lane) = x%blocks%lipschitz
         lanes%block%coarse(lane) = max(1.0_wp, x%blocks%coarse)
         lanes%block%has_right_sides = lanes%block%has_right_sides .or. x%blocks%has_right_sides

         lanes%rows%constant(lane) = x%rows%constant
         lanes%d%x(lane) = x%d%x
         lanes%d%y(lane) = x%d%y
         lanes%e%x(lane) = x%e%x
         lanes%e%y(lane) = x%e%y
         lanes%numbers%ground%x(lane) = x%loops%ground%x
         lanes%numbers%ground%y(lane) = x%loops%ground%y
         lanes%numbers%direction%x(lane) = x%loops%direction%x
         lanes%numbers%direction%y(lane) = x%loops%direction%y
         lanes%u%value(lane) = u%value
         lanes%u%rate(lane) = u%rate
         lanes%u%acceleration(lane) = u%acceleration
         lanes%u%c(lane) = u%c
         lanes%u%s(lane) = u%s
      end associate

      ! Of motions before the latest there are no values.
      do k = 0, 2
         associate (slot => lanes%slot(k), from => continuation%history%slot(k))
            lanes%t(lane, slot) = continuation%history%t(k)
            do i = 1, size(lanes%predicted)
               associate (past => continuation%history%past(lanes%predicted(i)))
                  lanes%past(lane, :, slot, lanes%predicted(i)) = [past%value, past%rate(from), past%acceleration(from)]
               end associate
            end do
         end associate
      end do
      lanes%block%sign_of(lane) = continuation%history%jacobian%sign_of
      lanes%block%pivot(lane, lanes%slot(0)) = continuation%history%jacobian%pivot
      lanes%block%inverse(lane, lanes%slot(0)) = continuation%history%jacobian%inverse
   end subroutine load_lane

   !> Gives a mechanism the last three motions of a lane: they become the history from which the mechanism is followed.
   subroutine unload_lane(lanes, lane, continuation)
      type(lanes_t), intent(in) :: lanes     !< with three motions of the lane
      integer, intent(in) :: lane            !< the number of the lane
      type(continuation_t), intent(inout) :: continuation   !< of the mechanism; gets the motions
      integer :: k, i, u

      do k = 0, 2
         associate (slot => lanes%slot(k), to => continuation%history%slot(k))
            continuation%history%t(k) = lanes%t(lane, slot)
            do i = 1, size(lanes%predicted)
               u = lanes%predicted(i)
               if (k == 0) continuation%history%past(u)%value = lanes%past(lane, 1, slot, u)
               continuation%history%past(u)%rate(to) = lanes%past(lane, 2, slot, u)
               continuation%history%past(u)%acceleration(to) = lanes%past(lane, 3, slot, u)
            end do
         end associate
      end do
      continuation%history%filled = 3
      associate (slot => lanes%slot(0))
         continuation%history%jacobian%sign_of = nint(lanes%block%sign_of(lane))
         continuation%history%jacobian%pivot = lanes%block%pivot(lane, slot)
         continuation%history%jacobian%inverse = lanes%block%inverse(lane, slot)
      end associate
   end subroutine unload_lane
end module lane_state
