!> The rows of some requests of a set at the instants of TIME and at times between them, for the questions about the
!> whole run.
module nodes
   use kinds, only: wp
   implicit none
   private
   public :: sample_t, node_t, extreme_t, times_between, joint_margin, order_along

   !> The nodes next to a joint are so far from it, in parts of the time or of the run: `drives` takes a nearer time as
   !> the joint itself.
   real(wp), parameter :: joint_margin_part = 65536.0_wp*epsilon(1.0_wp)
   !> Between two joints there are at least `parts_of_gap` parts, and at most `max_parts`.
   integer, parameter :: parts_of_gap = 8, max_parts = 120

   !> A coordinate of a row at one time, in the deck's unit or rad.
   type :: sample_t
      real(wp) :: t = 0.0_wp            !< time
      real(wp) :: f(0:2) = 0.0_wp       !< value, rate, acceleration
      real(wp) :: error(0:2) = 0.0_wp   !< of `f`, if digits of a table could be in doubt
      integer :: known = -1             !< as in `row_t`; 2: all of `f`
      logical :: meets = .false.        !< points of a measure coincide: at most its value is known
      real(wp) :: amplification = 0.0_wp       !< factor of roundings, if no digits could be in doubt
      real(wp) :: t_error = 0.0_wp      !< error of `t`, if that is the time of a zero
   end type sample_t

   !> The coordinates of one independent mechanism at one time. Small, since lanes have many of them.
   type :: node_t
      real(wp) :: t = 0.0_wp                   !< time
      !> All of the motion is known, and each number has known digits: others could be extremes or not.
      logical :: is_known = .false.
      logical :: is_lost = .false.             !< of some row nothing is known
      type(sample_t), allocatable :: samples(:)   !< (coordinates)
   end type node_t

   !> The least or the greatest value of a number, or a value that may be that. In the deck's unit or rad.
   type :: extreme_t
      logical :: exists = .false.
      logical :: has_bound = .true.                    !< false: the number grows without bound before the time `t`
      logical :: is_located = .false.                  !< at a zero of a derivative or as a limit, not at a node
      real(wp) :: t = 0.0_wp, value = 0.0_wp           !< without a bound, some value with the sign
      real(wp) :: t_error = 0.0_wp, error = 0.0_wp     !< errors of `t` and `value` by rounding
   end type extreme_t

contains

   !> Finds the times (any number) of the nodes between two instants, in the run's order: at each joint of the drives'
   !> laws and on either side of it, and between joints. No part is longer than an eighth of the time from joint to
   !> joint, unless there would be more than `max_parts`.
   pure function times_between(joints, longest, run, t1, t2) result(times)
      real(wp), intent(in) :: joints(:)      !< (joints) times, in the run's order
      real(wp), intent(in) :: longest        !< time of the longest part, unless there would be too many
      real(wp), intent(in) :: run            !< time of the whole run
      real(wp), intent(in) :: t1, t2         !< times of the instants, in the run's order
      real(wp), allocatable :: times(:)
      real(wp) :: way, from, to, part
      integer :: i, k, low, high, parts

      way = sign(1.0_wp, t2 - t1)
      low = count((joints - t1)*way <= 0.0_wp)
      high = count((joints - t2)*way < 0.0_wp)
      allocate (times(0))
      from = t1
      do i = low, high
         to = t2
         part = longest
         if (i < size(joints)) then
            if (i < high) to = joints(i + 1)
            if (i > 0) part = min(part, abs(joints(i + 1) - joints(i))/parts_of_gap)
            times = [times, joints(i + 1) + way*joint_margin(run, joints(i + 1))*[(k, k=-1, 1)]]
         end if
         if (i > 0) times = [times, joints(i) + way*joint_margin(run, joints(i))]

         ! Joints of two drives may be one.
         parts = 0
         if (abs(to - from) > 0.0_wp) &
            parts = ceiling(min(real(max_parts, wp), abs(to - from)/part*(1.0_wp - joint_margin_part)))
         times = [times, (from + (to - from)*k/parts, k=1, parts - 1)]
         from = to
      end do
      times = pack(times, (times - t1)*way > 0.0_wp .and. (t2 - times)*way > 0.0_wp)
      times = times(order_along(times, way))
   end function times_between

   !> Gives the time between a joint and the nodes next to it.
   pure real(wp) function joint_margin(run, t)
      real(wp), intent(in) :: run            !< time of the whole run
      real(wp), intent(in) :: t              !< time of the joint

      joint_margin = joint_margin_part*max(abs(t), abs(run))
   end function joint_margin

   !> Gives the numbers (times) of times in their order. Times that are in order cost one comparison each.
   pure function order_along(times, step) result(order)
      real(wp), intent(in) :: times(:)       !< (any number)
      real(wp), intent(in) :: step           !< above 0: upwards; otherwise downwards
      integer :: order(size(times)), i, k

      do i = 1, size(times)
         do k = i - 1, 1, -1
            if ((times(order(k)) - times(i))*sign(1.0_wp, step) <= 0.0_wp) exit
            order(k + 1) = order(k)
         end do
         order(k + 1) = i
      end do
   end function order_along
end module nodes
