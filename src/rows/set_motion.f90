!> The motion of a set at one instant, as the writers take it: that of each of its independent mechanisms (its
!> parts), how far it is known, and the rows that the set asks for, in the order of the cards.
module set_motion
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use motion, only: motion_t, new_motion, mark_none
   use independent, only: set_t, divide, request_of
   use structure, only: findings_t
   use points, only: row_t, find_row
   use error_estimate, only: error_estimate_t
   use sensitivities, only: sensitivities_t
   use motion_proof, only: motion_proof_t
   implicit none
   private
   public :: set_motion_t, new_set_motion, is_flagged, has_words, find_row_in_set

   !> Of each part, as many as the set has.
   type, extends(set_t) :: set_motion_t
      type(motion_t), allocatable :: motions(:)
      type(error_estimate_t), allocatable :: errors(:)
      type(sensitivities_t), allocatable :: sensitivities(:)
      type(motion_proof_t), allocatable :: proofs(:)
      logical :: has_begun = .false.                !< the first instant is taken
      type(motion_t), allocatable :: first(:)       !< its motions; of size 0 if no extremes are asked for
   end type set_motion_t

contains

   !> Divides a set into its parts, at rest.
   subroutine new_set_motion(m, s, findings)
      type(mechanism_t), intent(in) :: m
      type(set_motion_t), intent(out) :: s
      type(findings_t), intent(inout), optional :: findings   !< they give up their set if it is divided
      integer :: c
      logical :: is_divided

      is_divided = .false.
      if (present(findings)) is_divided = allocated(findings%set)
      if (is_divided) then
         s%set_t = findings%set
         deallocate (findings%set)
      else
         call divide(m, s%set_t)
      end if
      allocate (s%motions(s%count), s%errors(s%count), s%sensitivities(s%count), s%proofs(s%count))
      allocate (s%first(merge(s%count, 0, any([(any(s%parts(c)%requests%extremes), c=1, s%count)]))))
      do c = 1, s%count
         s%motions(c) = new_motion(size(s%parts(c)%links))
      end do
   end subroutine new_set_motion

   !> Tells whether some part has not all of its motion.
   pure logical function is_flagged(s)
      type(set_motion_t), intent(in) :: s

      is_flagged = any(s%motions%mark /= mark_none)
   end function is_flagged

   !> Tells whether the instant has marks or diagnostics in addition to its numbers.
   pure logical function has_words(s)
      type(set_motion_t), intent(in) :: s
      integer :: c

      has_words = is_flagged(s)
      do c = 1, s%count
         has_words = has_words .or. allocated(s%motions(c)%diagnostics)
      end do
   end function has_words

   !> Finds the row of a request of the set.
   pure subroutine find_row_in_set(s, i, row)
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: i               !< its number among the requests of the set
      type(row_t), intent(inout) :: row

      associate (c => s%rows(i)%part)
         call find_row(s%parts(c), s%motions(c), request_of(s, i), row)
      end associate
   end subroutine find_row_in_set
end module set_motion

