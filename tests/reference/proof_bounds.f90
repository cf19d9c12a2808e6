!> Tests. `proof_bounds DECK...`: what card PROVE proves of every deck, beside the closed forms in real128. No bound of
!> any number of any link at any instant is below its true error, and every instant is proved, the position and the step
!> to it, but instants at a change point and steps that pass one or begin at it. The last line is `N passed, N failed`.
program proof_bounds
   use kinds, only: wp
   use mechanism, only: mechanism_t, plane_origin, instant_count, instant, with_all_links, method_newton
   use motion, only: motion_t, flag_none, flag_singular, singular_change
   use continuation, only: branch_crossed
   use set_analysis, only: set_analysis_t, make_set_analysis, advance_set, prove_set
   use motion_proof, only: holds
   use balls, only: ball_t, distance
   use ball_numbers, only: number_error
   use quad_jet, only: qp
   use closed_forms_dyads, only: body_t
   use motion_errors, only: away
   use test_counter, only: test_counter_t, count_one, conclude, deck_name, sets_of
   use closed_forms, only: closed_form
   use expected_groups, only: change_times
   implicit none

   !> Times of instants agree with those of change points up to this.
   real(wp), parameter :: same_time = 1.0e-9_wp
   enum, bind(c)
      enumerator :: is_proved = 0, at_change, passes_change, other_reason
   end enum

   type(test_counter_t) :: counter
   character(500) :: path
   real(wp) :: worst(0:2)
   integer :: i

   worst = 0.0_wp
   do i = 1, command_argument_count()
      call get_command_argument(i, path)
      call check_deck(trim(path))
   end do
   print '(a,3f8.4)', ' LARGEST TRUE ERROR OVER ITS BOUND: POSITION, VELOCITY, ACCELERATION', worst
   call conclude(counter)

contains

   subroutine check_deck(path)
      character(*), intent(in) :: path
      type(mechanism_t), allocatable :: sets(:)
      integer :: i

      sets = sets_of(path)
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
         if (.not. all(holds(a%now%proofs(1:)))) open = open + 1
         if (reason_found(a) /= reason_expected(m, name, k)) wrong = wrong + 1
         do c = 1, a%now%count
            if (a%now%proofs(c)%is_proved) call weigh(a%now%parts(c), a%now%motions(c), a%now%proofs(c)%links, &
               closed_form(name, m%set_number, real(instant(m, k), qp)), below)
         end do
      end do
      if (open > 0 .or. wrong > 0) print '(1x,a,i0,a,i0)', name//', ', m%set_number, ': NOT PROVED ', open
      call count_one(counter, wrong == 0, name//': every step is proved but at change points')
      call count_one(counter, below == 0, name//': no bound is below the true error')
   end subroutine check_set

   !> Why instant number `k` of `m`, the deck `name`, is not proved: is_proved, at_change or passes_change. At a change
   !> point all links of a loop are in line.
   pure integer function reason_expected(m, name, k) result(reason)
      type(mechanism_t), intent(in) :: m
      character(*), intent(in) :: name
      integer, intent(in) :: k
      real(wp) :: t, before

      reason = is_proved
      if (k == 0) return
      t = instant(m, k)
      before = instant(m, k - 1)
      associate (change => change_times(name))
         if (any(change > min(before, t) - same_time .and. change < max(before, t) + same_time)) reason = passes_change
         if (any(abs(change - t) < same_time)) reason = at_change
      end associate
   end function reason_expected

   !> Why the instant is not proved that `a` has come to, by its flags and branches.
   pure integer function reason_found(a) result(reason)
      type(set_analysis_t), intent(in) :: a

      reason = is_proved
      if (all(holds(a%now%proofs(1:)))) return
      reason = other_reason
      associate (q => a%now%motions(1), proof => a%now%proofs(1))
         if (q%flag == flag_singular .and. q%singularity == singular_change .and. .not. proof%is_proved) reason = &
            at_change
         if (q%flag == flag_none .and. proof%is_proved .and. a%list(1)%branch%kind == branch_crossed) reason = &
            passes_change
      end associate
   end function reason_found

   !> The true errors of all links of `m` in its motion `q` beside the bounds of `links` (3, 0:2, links); `below`:
   !> bounds that are too small.
   subroutine weigh(m, q, links, exact, below)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(ball_t), intent(in) :: links(:, 0:, :)
      type(body_t), intent(in) :: exact(:)
      integer, intent(inout) :: below
      real(wp) :: bound(3, 0:2), off(3, 0:2)
      integer :: i, k, at

      do i = 1, size(m%links)
         at = findloc(exact%name == m%links(i)%name, .true., dim=1)
         if (m%links(i)%ground .or. at == 0) cycle
         bound(:, 0) = distance(links(:, 0, i), q%position(:, i))
         bound(:, 1) = distance(links(:, 1, i), q%velocity(:, i))
         bound(:, 2) = distance(links(:, 2, i), q%acceleration(:, i))
         ! The closed forms have places in the deck's coordinates, whose origin has roundings of its own.
         bound(:2, 0) = bound(:2, 0) + 2.0_wp*number_error*norm2(plane_origin(m))
         off = away(q, i, exact(at))
         below = below + count(off > bound)
         if (any(off > bound)) print '(1x,2a,f0.6,9es9.1/20x,9es9.1)', trim(m%links(i)%name), ' AT ', q%t, off, bound
         do k = 0, 2
            worst(k) = max(worst(k), maxval(off(:, k)/max(bound(:, k), tiny(1.0_wp))))
         end do
      end do
   end subroutine weigh
end program proof_bounds
