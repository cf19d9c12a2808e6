!> The rows of some requests of a set at the instants of TIME and at times between them, where what is asked of the
!> whole run looks for something.
module nodes
   use kinds, only: wp
   implicit none
   private
   public :: sample_t, node_t, extreme_t, times_between, beside_joint, order_along

   !> Just beside a joint, in parts of the time or of the run: `drives` takes what is nearer as the joint itself.
   real(wp), parameter :: joint_part = 65536.0_wp*epsilon(1.0_wp)
   !> The parts between two joints at least, and at most.
   integer, parameter :: parts_of_gap = 8, max_parts = 120
   !> A coordinate of a row at one time, in the deck's unit or rad.
   type :: sample_t
      real(wp) :: t = 0.0_wp            !< time
      real(wp) :: f(0:2) = 0.0_wp       !< value, rate, acceleration
      real(wp) :: error(0:2) = 0.0_wp   !< of them, where digits of a table could be in doubt
      integer :: known = -1             !< as in `row_t`; 2: all of `f`
      logical :: meets = .false.        !< points of a measure coincide: at most its value is known
      real(wp) :: growth = 0.0_wp       !< by which roundings grow where no digits could be in doubt
      real(wp) :: t_error = 0.0_wp      !< of the time of a zero
   end type sample_t

   !> The coordinates of one independent mechanism at one time. Small, since lanes have many of them.
   type :: node_t
      real(wp) :: t = 0.0_wp                   !< time
      !> All of the motion is known, and of no number all digits are open: such a one cannot be told to be an extreme,
      !> nor to be none.
      logical :: is_known = .false.
      logical :: is_lost = .false.             !< of some row nothing is known
      type(sample_t), allocatable :: samples(:)   !< (coordinates)
   end type node_t

   !> The least or the greatest value of a number, or what may be that. In the deck's unit or rad.
   type :: extreme_t
      logical :: exists = .false.
      logical :: has_bound = .true.                    !< false: the number grows without bound before the time `t`
      logical :: is_located = .false.                  !< at a zero of a derivative or as a limit, not at a node
      real(wp) :: t = 0.0_wp, value = 0.0_wp           !< of what has no bound, a value with its sign
      real(wp) :: t_error = 0.0_wp, error = 0.0_wp     !< what rounding leaves open of both
   end type extreme_t

contains

   !> The times of the nodes between `t1` and `t2`, instants of a run of the time `run`, in their order: at each of the
   !> `joints` of the drives' laws, which are in this order too, and on either side of it; and between them, so that no
   !> part is longer than `longest` or an eighth of the time from joint to joint.
   pure function times_between(joints, longest, run, t1, t2) result(times)
      real(wp), intent(in) :: joints(:), longest, run, t1, t2
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
            times = [times, joints(i + 1) + way*beside_joint(run, joints(i + 1))*[(k, k=-1, 1)]]
         end if
         if (i > 0) times = [times, joints(i) + way*beside_joint(run, joints(i))]
         ! Joints of two drives may be one.
         parts = 0
         if (abs(to - from) > 0.0_wp) &
            parts = ceiling(min(real(max_parts, wp), abs(to - from)/part*(1.0_wp - joint_part)))
         times = [times, (from + (to - from)*k/parts, k=1, parts - 1)]
         from = to
      end do
      times = pack(times, (times - t1)*way > 0.0_wp .and. (t2 - times)*way > 0.0_wp)
      times = times(order_along(times, way))
   end function times_between

   !> How far from a joint at the time `t` are the nodes just beside it, in a run of the time `run`.
   pure real(wp) function beside_joint(run, t)
      real(wp), intent(in) :: run, t

      beside_joint = joint_part*max(abs(t), abs(run))
   end function beside_joint

   !> The numbers of the `times` in their order, upwards where `step` > 0, otherwise downwards. What is in order already
   !> is only looked at.
   pure function order_along(times, step) result(order)
      real(wp), intent(in) :: times(:), step
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
