!> The motion of a set at one instant, as the writers take it: that of each of its independent mechanisms (its
!> parts), how far it is known, and where to find the row that a request asks for.
module set_motion
   use kinds, only: wp
   use mechanism, only: mechanism_t, tolerance_t, request_pole
   use motion, only: motion_t, new_motion, mark_none, diagnostic_t
   use independent, only: part_t, parts_t, find_parts, mechanism_of
   use structure, only: findings_t
   use points, only: row_t, find_row
   use known_digits, only: has_known_digit
   use error_estimate, only: error_estimate_t, estimate_of, row_error
   use sensitivities, only: sensitivities_t, ground_sensitivities
   use motion_proof, only: motion_proof_t
   implicit none
   private
   public :: set_motion_t, new_set_motion, take_whole, is_flagged, has_words, in_set, put_together, find_row_in_set
   public :: doubt_in_set, known_numbers, error_in_set, spread_t, spread_in_set

   !> A set that is one mechanism is one part, with the numbers of the set.
   type :: set_motion_t
      type(parts_t) :: parts                            !< which link, point, pair and drive is in which
      type(mechanism_t), allocatable :: own(:)          !< (parts) each as a set of its own
      type(motion_t), allocatable :: motions(:)         !< (parts)
      type(error_estimate_t), allocatable :: errors(:)  !< (parts)
      type(sensitivities_t), allocatable :: sensitivities(:)   !< (parts)
      type(motion_proof_t), allocatable :: proofs(:)    !< (parts)
   end type set_motion_t

   !> The sensitivities of a row to the numbers with tolerances, and these.
   type :: spread_t
      integer :: known = 2                              !< as of a row: -1 none of them exists
      real(wp), allocatable :: of(:, :, :), error(:, :, :)   !< (3, 0:2, numbers) and what is unknown of them
      type(tolerance_t), allocatable :: tolerances(:)   !< (numbers)
   end type spread_t

contains

   !> The parts of `m`, at rest. `findings`: those of its structure, which give up the parts they have found.
   subroutine new_set_motion(m, s, findings)
      type(mechanism_t), intent(in) :: m
      type(set_motion_t), intent(out) :: s
      type(findings_t), intent(inout), optional :: findings
      integer :: c

      if (present(findings)) then
         s%parts = findings%parts
         call move_alloc(findings%own, s%own)
      else
         call find_parts(m, s%parts, s%own)
      end if
      if (s%parts%count == 1) then
         call take_whole(m, s%parts)
         deallocate (s%own)
         allocate (s%own(1))
         s%own(1) = mechanism_of(m, s%parts%list(1))
      end if
      allocate (s%motions(s%parts%count), s%errors(s%parts%count), s%sensitivities(s%parts%count), &
         s%proofs(s%parts%count))
      do c = 1, size(s%own)
         s%motions(c) = new_motion(size(s%own(c)%links))
      end do
   end subroutine new_set_motion

   !> All of `m` as one part.
   pure subroutine take_whole(m, parts)
      type(mechanism_t), intent(in) :: m
      type(parts_t), intent(inout) :: parts
      integer :: i

      allocate (parts%list(1))
      associate (whole => parts%list(1))
         whole%links = [(i, i=1, size(m%links))]
         whole%points = [(i, i=1, size(m%points))]
         whole%pairs = [(i, i=1, size(m%pairs))]
         whole%drives = [(i, i=1, size(m%drives))]
         whole%requests = [(i, i=1, size(m%requests))]
         allocate (whole%branch_requests(0))
         if (allocated(m%branch_requests)) whole%branch_requests = [(i, i=1, size(m%branch_requests))]
         parts%number = whole%requests
      end associate
      allocate (parts%part(size(m%requests)), source=1)
   end subroutine take_whole

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
      do c = 1, size(s%motions)
         has_words = has_words .or. allocated(s%motions(c)%diagnostics)
      end do
   end function has_words

   !> The motion `q` of all links of the set, known as far as that of every part is; places are counted from where each
   !> part counts them.
   subroutine put_together(s, q)
      type(set_motion_t), intent(in) :: s
      type(motion_t), intent(inout) :: q
      integer :: c

      q%t = s%motions(1)%t
      q%known = minval(s%motions%known)
      q%mark = s%motions(minloc(s%motions%known, dim=1))%mark
      do c = 1, size(s%own)
         associate (links => s%parts%list(c)%links)
            q%position(:, links) = s%motions(c)%position
            q%velocity(:, links) = s%motions(c)%velocity
            q%acceleration(:, links) = s%motions(c)%acceleration
         end associate
      end do
   end subroutine put_together

   !> The `row` of request number `i` of `m`. A row of the ground, which is no part's, is known by the deck alone.
   pure subroutine find_row_in_set(m, s, i, row)
      type(mechanism_t), intent(in) :: m
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: i
      type(row_t), intent(inout) :: row
      integer :: c

      c = s%parts%part(i)
      if (c > 0) call find_row(s%own(c), s%motions(c), s%own(c)%requests(s%parts%number(i)), row)
      if (c == 0) call find_row(m, s%motions(1), m%requests(i), row)
   end subroutine find_row_in_set

   !> What rounding leaves open (3, 0:2) of the `row` of request number `i`; 0 where no digit of a table is in doubt.
   pure function doubt_in_set(row, s, i) result(error)
      type(row_t), intent(in) :: row
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: i
      real(wp) :: error(3, 0:2)

      error = 0.0_wp
      if (s%parts%part(i) == 0) return
      associate (c => s%parts%part(i))
         if (s%errors(c)%taken .and. s%errors(c)%in_doubt) error = estimate_of(row, s%own(c), s%errors(c), &
            s%motions(c), s%own(c)%requests(s%parts%number(i)))
      end associate
   end function doubt_in_set

   !> Of which numbers (3, 0:2) of the `row` of request number `i`, as far as it has them, a digit is known.
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
            associate (sizes => s%errors(s%parts%part(i))%sizes)
               size_of = merge(1.0_wp, sizes%length, c == 3 .or. row%angular)
               ! Poles and curves are places, in other axes.
               if (row%kind < request_pole) size_of = size_of*sizes%rate**k
            end associate
            known(c, k) = has_known_digit(row%value(c, k), error(c, k), size_of)
         end do
      end do
   end function known_numbers

   !> The estimated error (3, 0:2) of the row of request number `i` of `m`, where errors are asked for.
   pure function error_in_set(m, s, i) result(error)
      type(mechanism_t), intent(in) :: m
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: i
      real(wp) :: error(3, 0:2)
      integer :: c

      c = s%parts%part(i)
      if (c > 0) error = row_error(s%own(c), s%errors(c), s%motions(c), s%own(c)%requests(s%parts%number(i)))
      if (c == 0) error = row_error(m, error_estimate_t(), s%motions(1), m%requests(i))
   end function error_in_set

   !> The sensitivities of the row of request number `i` of `m`.
   function spread_in_set(m, s, i) result(x)
      type(mechanism_t), intent(in) :: m
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: i
      type(spread_t) :: x

      if (s%parts%part(i) == 0) then
         x%of = ground_sensitivities(m, m%requests(i))
         x%error = 0.0_wp*x%of
         x%tolerances = m%tolerances
      else
         associate (found => s%sensitivities(s%parts%part(i)), k => s%parts%number(i))
            x%known = found%known(k)
            x%of = found%of(:, :, :, k)
            x%error = found%error(:, :, :, k)
            x%tolerances = s%own(s%parts%part(i))%tolerances
         end associate
      end if
   end function spread_in_set

   !> The diagnostic `r` of a part in the numbers of the set.
   pure type(diagnostic_t) function in_set(r, part)
      type(diagnostic_t), intent(in) :: r
      type(part_t), intent(in) :: part

      in_set = r
      if (r%pair > 0) in_set%pair = part%pairs(r%pair)
      if (r%drive > 0) in_set%drive = part%drives(r%drive)
      where (r%links > 0) in_set%links = part%links(max(1, r%links))
   end function in_set
end module set_motion
