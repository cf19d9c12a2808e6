!> Tests. The largest errors of a run of the program against a closed form in real128.
module motion_errors
   use kinds, only: wp
   use quad_jet, only: qp, pi_q
   use mechanism, only: mechanism_t
   use motion, only: motion_t, new_motion, mark_none
   use analysis, only: analysis_t, make_analysis, advance
   use closed_forms_dyads, only: body_t
   use closed_forms, only: closed_form
   implicit none
   private
   public :: errors_t, run_errors, difference, exact_positions

   type :: errors_t
      real(wp) :: position = 0.0_wp, velocity = 0.0_wp, acceleration = 0.0_wp
      integer :: unsolved = 0      !< instants with a mark, not compared
      integer :: iterations = 0    !< largest number at one instant after the first
   end type errors_t

contains

   !> Runs `m` at `t1` k/`steps`, k = 0 to `steps`, against set `set` of the closed form `name`; rates are divided by
   !> `rate` and its square, lengths as they are.
   function run_errors(m, name, set, t1, steps, rate) result(e)
      type(mechanism_t), intent(in) :: m
      character(*), intent(in) :: name
      integer, intent(in) :: set, steps
      real(wp), intent(in) :: t1, rate
      type(errors_t) :: e
      type(analysis_t) :: a
      type(motion_t) :: q
      real(wp) :: one(0:2), t
      integer :: k

      call make_analysis(a, m)
      q = new_motion(size(m%links))
      do k = 0, steps
         t = t1*real(k, wp)/real(steps, wp)
         call advance(a, t, q)
         if (q%mark /= mark_none) then
            e%unsolved = e%unsolved + 1
            cycle
         end if
         if (k > 0) e%iterations = max(e%iterations, a%convergence%iterations)
         one = difference(q, closed_form(name, set, real(t, qp)))
         e%position = max(e%position, one(0))
         e%velocity = max(e%velocity, one(1)/rate)
         e%acceleration = max(e%acceleration, one(2)/rate**2)
      end do
   end function run_errors

   !> Largest difference (0:2) of position, velocity, acceleration; angles modulo a whole turn.
   function difference(q, exact) result(d)
      type(motion_t), intent(in) :: q
      type(body_t), intent(in) :: exact(:)
      real(wp) :: d(0:2)
      real(qp) :: turn
      integer :: i

      d = 0.0_wp
      do i = 1, size(exact)
         turn = q%position(3, i) - exact(i)%phi%v
         turn = turn - 2.0_qp*pi_q*anint(turn/(2.0_qp*pi_q))
         d(0) = max(d(0), real(maxval(abs([q%origin + q%position(:2, i) - [exact(i)%x%v, exact(i)%y%v], turn])), wp))
         d(1) = max(d(1), real(maxval(abs(q%velocity(:, i) - [exact(i)%x%d, exact(i)%y%d, exact(i)%phi%d])), wp))
         d(2) = max(d(2), real(maxval(abs(q%acceleration(:, i) - [exact(i)%x%dd, exact(i)%y%dd, exact(i)%phi%dd])), wp))
      end do
   end function difference

   !> Positions (3, links) of a closed form, angles in (-pi, pi] but for the drive's.
   function exact_positions(name, set, t) result(q)
      character(*), intent(in) :: name
      integer, intent(in) :: set
      real(wp), intent(in) :: t
      real(wp), allocatable :: q(:, :)
      type(body_t), allocatable :: exact(:)
      integer :: i

      exact = closed_form(name, set, real(t, qp))
      allocate (q(3, size(exact)))
      do i = 1, size(exact)
         q(:, i) = real([exact(i)%x%v, exact(i)%y%v, exact(i)%phi%v], wp)
      end do
   end function exact_positions
end module motion_errors
