!> Tests. `proof_bounds DECK...`: what card PROVE proves of every deck, beside the closed forms in real128. No bound of any
!> number of any link at any instant is below its true error, and every instant is proved but those of the list: the
!> position, and the step to it. The last line is `N passed, N failed`.
program proof_bounds
   use kinds, only: wp
   use failures, only: failure_t
   use mechanism, only: mechanism_t, request_t, request_link, instant_count, instant, with_all_links, method_newton
   use motion, only: motion_t
   use deck, only: read_deck
   use set_analysis, only: set_analysis_t, make_set_analysis, advance_set, prove_set
   use motion_proof, only: holds
   use link_bounds, only: row_bound
   use quad_jet, only: qp, pi_q
   use closed_forms_dyads, only: body_t
   use deck_tally, only: certificate_counts_t, count_one, conclude, deck_name
   use closed_forms, only: closed_form
   implicit none

   !> What is not proved: the position is a change point, or the step passes one.
   type :: exception_t
      character(24) :: deck
      integer :: instants(4)
   end type exception_t
   type(exception_t), parameter :: exceptions(*) = [ &
      exception_t('antiparallelogram_across', [14, 28, 0, 0]), exception_t('antiparallelogram_at', [11, 12, 0, 0]), &
      exception_t('antiparallelogram_branch', [2, 16, 0, 0]), exception_t('kite_across', [16, 34, 0, 0]), &
      exception_t('kite_at', [8, 9, 17, 18]), exception_t('kite_branch', [16, 34, 0, 0]), &
      exception_t('parallelogram', [16, 34, 0, 0]), exception_t('parallelogram_at', [8, 9, 17, 18]), &
      exception_t('parallelogram_branch', [16, 34, 0, 0]), exception_t('scott_russell', [5, 20, 0, 0]), &
      exception_t('scott_russell_at', [5, 6, 20, 21]), exception_t('scott_russell_branch', [5, 20, 0, 0])]

   !> The closed forms are rounded as well.
   real(qp), parameter :: reference_rounding = 1.0e-30_qp

   type(certificate_counts_t) :: tally
   character(500) :: path
   real(wp) :: worst(0:2)
   integer :: i

   worst = 0.0_wp
   do i = 1, command_argument_count()
      call get_command_argument(i, path)
      call check_deck(trim(path))
   end do
   print '(a,3f8.4)', ' LARGEST TRUE ERROR OVER ITS BOUND: POSITION, VELOCITY, ACCELERATION', worst
   call conclude(tally)

contains

   subroutine check_deck(path)
      character(*), intent(in) :: path
      character(:), allocatable :: report
      type(mechanism_t), allocatable :: sets(:)
      type(failure_t), allocatable :: failure
      integer :: i

      call read_deck(path, sets, report, failure)
      if (allocated(failure)) error stop 'A DECK IS NOT READ'
      do i = 1, size(sets)
         if (sets(i)%method == method_newton) call check_set(deck_name(path), with_all_links(sets(i)))
      end do
   end subroutine check_deck

   subroutine check_set(name, m)
      character(*), intent(in) :: name
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t) :: a
      integer :: k, c, open, wrong, below, first

      call make_set_analysis(m, a)
      open = 0
      wrong = 0
      below = 0
      first = -1
      do k = 0, instant_count(m) - 1
         call advance_set(a, instant(m, k))
         call prove_set(a, .true.)
         if (.not. all(holds(a%now%proofs))) open = open + 1
         if (all(holds(a%now%proofs)) .eqv. is_exception(name, k)) wrong = wrong + 1
         do c = 1, size(a%now%own)
            if (a%now%proofs(c)%is_proved) call weigh(a%now%own(c), a%now%motions(c), a%now%proofs(c)%links, &
               closed_form(name, m%set_number, real(instant(m, k), qp)), below)
         end do
      end do
      if (open > 0 .or. wrong > 0) print '(1x,a,i0,a,i0)', name//', ', m%set_number, ': NOT PROVED ', open
      call count_one(tally, wrong == 0, name//': every step is proved but those of the list')
      call count_one(tally, below == 0, name//': no bound is below the true error')
   end subroutine check_set

   !> Instant number `k` of the deck `name` is not proved.
   pure logical function is_exception(name, k)
      character(*), intent(in) :: name
      integer, intent(in) :: k
      integer :: i

      is_exception = .false.
      if (k == 0) return
      do i = 1, size(exceptions)
         if (exceptions(i)%deck == name) is_exception = any(exceptions(i)%instants == k)
      end do
   end function is_exception

   !> The true errors of all links of `m` in its motion `q` beside the bounds of `links` (3, 0:2, links); `below`: bounds
   !> that are too small.
   subroutine weigh(m, q, links, exact, below)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: links(:, 0:, :)
      type(body_t), intent(in) :: exact(:)
      integer, intent(inout) :: below
      real(wp) :: bound(3, 0:2), off(3, 0:2)
      integer :: i, k, at

      do i = 1, size(m%links)
         at = findloc(exact%name == m%links(i)%name, .true., dim=1)
         if (m%links(i)%ground .or. at == 0) cycle
         bound = row_bound(m, q, links, request_t(request_link, i))
         off = away(q, i, exact(at))
         below = below + count(off > bound)
         if (any(off > bound)) print '(1x,2a,f0.6,9es9.1/20x,9es9.1)', trim(m%links(i)%name), ' AT ', q%t, off, bound
         do k = 0, 2
            worst(k) = max(worst(k), maxval(off(:, k)/max(bound(:, k), tiny(1.0_wp))))
         end do
      end do
   end subroutine weigh

   !> How far (3, 0:2) link `i` of the motion `q` is from the truth, as it is printed.
   function away(q, i, exact) result(off)
      type(motion_t), intent(in) :: q
      integer, intent(in) :: i
      type(body_t), intent(in) :: exact
      real(wp) :: off(3, 0:2)
      real(qp) :: x(3, 0:2), right(3, 0:2)

      x(:, 0) = [q%position(:2, i) + q%origin, q%position(3, i)]
      x(:, 1) = q%velocity(:, i)
      x(:, 2) = q%acceleration(:, i)
      right(1, :) = [exact%x%v, exact%x%d, exact%x%dd]
      right(2, :) = [exact%y%v, exact%y%d, exact%y%dd]
      right(3, :) = [exact%phi%v, exact%phi%d, exact%phi%dd]
      right(3, 0) = right(3, 0) + 2.0_qp*pi_q*anint((x(3, 0) - right(3, 0))/(2.0_qp*pi_q))
      off = real(max(0.0_qp, abs(x - right) - reference_rounding), wp)
   end function away
end program proof_bounds
