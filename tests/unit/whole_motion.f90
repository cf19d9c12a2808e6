!> A set as writers take it, and a motion of one mechanism.
module whole_motion
   use mechanism, only: mechanism_t
   use motion, only: motion_t
   use error_estimate, only: error_estimate_t
   use independent, only: set_t, member_t, divide
   use set_motion, only: set_motion_t
   use rows, only: finished_row_t, find_rows
   implicit none
   private
   public :: one_motion, divided, rows_of

contains

   !> The motion `q` of all of `m`, and how far it is known, as a set of one part.
   function one_motion(m, q, errors) result(s)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(error_estimate_t), intent(in) :: errors
      type(set_motion_t) :: s
      integer :: i

      s%settings_t = m%settings_t
      s%parts = [m]
      s%rows = [(member_t(1, i), i=1, size(m%requests))]
      s%drives = [(member_t(1, i), i=1, size(m%drives))]
      allocate (s%cards(1))
      s%cards(1)%of = [(i, i=1, size(m%links))]
      allocate (s%motions(1), s%errors(1), s%sensitivities(1), s%proofs(1))
      s%motions(1) = q
      s%errors(1) = errors
   end function one_motion

   !> Gives all finished rows of the motions `s` at instant number `step`.
   function rows_of(s, step) result(rows)
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: step
      type(finished_row_t), allocatable :: rows(:)

      call find_rows(s, step, .true., rows)
   end function rows_of

   !> The set `m`, divided.
   function divided(m) result(s)
      type(mechanism_t), intent(in) :: m
      type(set_t) :: s

      call divide(m, s)
   end function divided
end module whole_motion
