!> The motion of a set at one instant, as the writers take it: that of each of its independent mechanisms (its
!> parts), how far it is known, and the rows that the set asks for, in the order of the cards.
module set_motion
   use kinds, only: wp
   use mechanism, only: mechanism_t, tolerance_t, request_pole
   use motion, only: motion_t, new_motion, mark_none
   use independent, only: set_t, divide, request_of
   use structure, only: findings_t
   use points, only: row_t, find_row
   use error_estimate, only: error_estimate_t, estimate_of, row_error
   use sensitivities, only: sensitivities_t
   use motion_proof, only: motion_proof_t
   implicit none
   private
   public :: set_motion_t, new_set_motion, is_flagged, has_words, find_row_in_set
   public :: doubt_in_set, known_numbers, error_in_set, spread_t, spread_in_set

   !> Of each part, as many as the set has.
   type, extends(set_t) :: set_motion_t
      type(motion_t), allocatable :: motions(:)
      type(error_estimate_t), allocatable :: errors(:)
      type(sensitivities_t), allocatable :: sensitivities(:)
      type(motion_proof_t), allocatable :: proofs(:)
   end type set_motion_t

   !> The sensitivities of a row to the numbers with tolerances, and these.
   type :: spread_t
      integer :: known = 2                              !< as of a row: -1 none of them exists
      real(wp), allocatable :: of(:, :, :), error(:, :, :)   !< (3, 0:2, numbers) and what is unknown of them
      type(tolerance_t), allocatable :: tolerances(:)   !< (numbers)
   end type spread_t

contains

   !> The parts of `m`, at rest. `findings`: those of its structure, which give up the set if they have divided it.
   subroutine new_set_motion(m, s, findings)
      type(mechanism_t), intent(in) :: m
      type(set_motion_t), intent(out) :: s
      type(findings_t), intent(inout), optional :: findings
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
      do c = 1, s%count
         s%motions(c) = new_motion(size(s%parts(c)%links))
      end do
   end subroutine new_set_motion

   !> Some part has not all of its motion.
   pure logical function is_flagged(s)
      type(set_motion_t), intent(in) :: s

      is_flagged = any(s%motions%mark /= mark_none)
   end function is_flagged

   !> There is something to say of the instant beside its numbers.
   pure logical function has_words(s)
      type(set_motion_t), intent(in) :: s
      integer :: c

      has_words = is_flagged(s)
      do c = 1, s%count
         has_words = has_words .or. allocated(s%motions(c)%diagnostics)
      end do
   end function has_words

   !> The `row` of request number `i` of the set.
   pure subroutine find_row_in_set(s, i, row)
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: i
      type(row_t), intent(inout) :: row

      associate (c => s%rows(i)%part)
         call find_row(s%parts(c), s%motions(c), request_of(s, i), row)
      end associate
   end subroutine find_row_in_set

   !> Tells what rounding leaves open (3, 0:2) of the `row` of request number `i`; 0 where no digit of a table is in
   !> doubt.
   pure function doubt_in_set(row, s, i) result(error)
      type(row_t), intent(in) :: row
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: i
      real(wp) :: error(3, 0:2)

      error = 0.0_wp
      associate (c => s%rows(i)%part)
         if (s%errors(c)%taken .and. s%errors(c)%in_doubt) &
            error = estimate_of(row, s%parts(c), s%errors(c), s%rows(i)%number)
      end associate
   end function doubt_in_set

   !> Tells of which numbers (3, 0:2) of the `row` of request number `i`, as far as it has them, a digit is known.
   pure function known_numbers(row, s, i) result(known)
      type(row_t), intent(in) :: row
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: i
      logical :: known(3, 0:2)
      real(wp) :: error(3, 0:2), size_of
      integer :: c, k

      error = doubt_in_set(row, s, i)
      known = .true.
      do k = 0, 2
         do c = 1, 3
            if (.not. error(c, k) > 0.0_wp) cycle
            associate (sizes => s%errors(s%rows(i)%part)%sizes)
               size_of = merge(1.0_wp, sizes%length, c == 3 .or. row%angular)
               ! Poles and curves are places, in other axes.
               if (row%kind < request_pole) size_of = size_of*sizes%rate**k
            end associate
            ! Its first digit is known, or the error is no large part of numbers of its kind.
            known(c, k) = 10.0_wp*error(c, k) <= max(abs(row%value(c, k)), size_of)
         end do
      end do
   end function known_numbers

   !> The estimated error (3, 0:2) of the row of request number `i`, where errors are asked for.
   pure function error_in_set(s, i) result(error)
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: i
      real(wp) :: error(3, 0:2)

      associate (c => s%rows(i)%part)
         error = row_error(s%parts(c), s%errors(c), s%motions(c), s%rows(i)%number)
      end associate
   end function error_in_set

   !> The sensitivities of the row of request number `i`.
   function spread_in_set(s, i) result(x)
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: i
      type(spread_t) :: x

      associate (found => s%sensitivities(s%rows(i)%part), k => s%rows(i)%number)
         x%tolerances = s%parts(s%rows(i)%part)%tolerances
         x%known = found%known(k)
         x%of = found%of(:, :, :, k)
         x%error = found%error(:, :, :, k)
      end associate
   end function spread_in_set
end module set_motion
