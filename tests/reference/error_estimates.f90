!> Tests. `error_estimates DECK...`: the errors that the program tells of its own results (--errors) beside their true
!> errors against closed forms in real128. An estimate must not be below the error, for no number of any link at any
!> instant, and of the largest of each instant no more than one in five may be more than 30 times too large. (A true
!> error may by chance be small: one below a rounding of the number's size counts as that.) The last line is `N passed,
!> N failed`.
program error_estimates
   use kinds, only: wp
   use mechanism, only: mechanism_t, instant_count, instant, request_link
   use motion, only: motion_t, new_motion
   use analysis, only: analysis_t, make_analysis, advance
   use error_estimate, only: error_estimate_t, estimator_t, make_estimator, estimate_errors, row_error
   use quad_jet, only: qp
   use closed_forms_dyads, only: body_t
   use motion_errors, only: away
   use test_counter, only: test_counter_t, count_one, conclude, deck_name, sets_of
   use closed_forms, only: closed_form
   implicit none
   real(wp), parameter :: max_above = 30.0_wp
   !> One in so many of the largest errors may be told too large.
   integer, parameter :: seldom = 5

   !> (position, velocity, acceleration) of one deck, and of all.
   type :: estimate_counts_t
      integer :: numbers = 0, below = 0, instants = 0, above = 0
      real(wp) :: worst(0:2) = 0.0_wp            !< true over estimate, the largest
      real(wp) :: ratio(0:2) = 0.0_wp            !< estimate over true, sum of logarithms
   end type estimate_counts_t

   type(estimate_counts_t) :: one, all_of_them
   type(test_counter_t) :: counter
   character(500) :: path
   integer :: i

   print '(a)', ' deck                     numbers  below  instants  above 30     true over estimate,' &
      //' largest     estimate over true, mean'
   do i = 1, command_argument_count()
      call get_command_argument(i, path)
      one = estimate_counts_t()
      call weigh_deck(trim(path), one)
      call print_counts(deck_name(trim(path)), one)
      call count_one(counter, one%below == 0, deck_name(trim(path))//': no estimate below its error')
      call add(one, all_of_them)
   end do
   call print_counts('all', all_of_them)
   call count_one(counter, seldom*all_of_them%above <= all_of_them%instants, 'estimates that are much too large')
   call conclude(counter)

contains

   subroutine weigh_deck(path, counts)
      character(*), intent(in) :: path
      type(estimate_counts_t), intent(inout) :: counts
      type(mechanism_t), allocatable :: sets(:)
      integer :: i

      sets = sets_of(path)
      do i = 1, size(sets)
         call weigh_set(deck_name(path), sets(i), counts)
      end do
   end subroutine weigh_deck

   subroutine weigh_set(name, m, counts)
      character(*), intent(in) :: name
      type(mechanism_t), intent(in) :: m
      type(estimate_counts_t), intent(inout) :: counts
      type(analysis_t) :: a
      type(motion_t) :: q
      type(estimator_t) :: samples
      type(error_estimate_t) :: doubt
      integer :: k

      call make_analysis(a, m)
      q = new_motion(size(m%links))
      call make_estimator(samples, m)
      do k = 0, instant_count(m) - 1
         call advance(a, instant(m, k), q)
         call estimate_errors(samples, m, a%blocks, a%geometry, a%state, q, .true., .true., doubt)
         if (q%known == 2) call weigh_instant(m, q, doubt, closed_form(name, m%set_number, real(q%t, qp)), counts)
      end do
   end subroutine weigh_set

   !> The links asked for, number by number, and the largest of the instant.
   subroutine weigh_instant(m, q, doubt, exact, counts)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(error_estimate_t), intent(in) :: doubt
      type(body_t), intent(in) :: exact(:)
      type(estimate_counts_t), intent(inout) :: counts
      real(wp) :: told(3, 0:2), true(3, 0:2), size_of(2, 0:2), max_told(2, 0:2), max_true(2, 0:2)
      integer :: i, k, link

      max_told = 0.0_wp
      max_true = 0.0_wp
      size_of = 0.0_wp
      do i = 1, size(m%requests)
         if (m%requests(i)%kind /= request_link) cycle
         link = findloc(exact%name == m%links(m%requests(i)%subject)%name, .true., dim=1)
         told = row_error(m, doubt, q, i)
         true = away(q, m%requests(i)%subject, exact(link))
         counts%numbers = counts%numbers + 9
         if (any(true > told)) then
            counts%below = counts%below + count(true > told)
            print '(a,f0.4,2a,9es9.1/20x,9es9.1)', ' below at ', q%t, ' ', m%links(m%requests(i)%subject)%name, true, &
               told
         end if
         do k = 0, 2
            counts%worst(k) = max(counts%worst(k), maxval(true(:, k)/max(told(:, k), tiny(1.0_wp))))
         end do
         max_told = max(max_told, reshape([maxval(told(:2, :), dim=1), told(3, :)], [2, 3], order=[2, 1]))
         max_true = max(max_true, reshape([maxval(true(:2, :), dim=1), true(3, :)], [2, 3], order=[2, 1]))
         size_of(1, :) = max(size_of(1, :), [maxval(abs(q%position(:2, m%requests(i)%subject) + q%origin)), &
            maxval(abs(q%velocity(:2, m%requests(i)%subject))), maxval(abs(q%acceleration(:2, m%requests(i)%subject)))])
         size_of(2, :) = max(size_of(2, :), [abs(q%position(3, m%requests(i)%subject)), &
            abs(q%velocity(3, m%requests(i)%subject)), abs(q%acceleration(3, m%requests(i)%subject))])
      end do
      max_true = max(max_true, epsilon(1.0_wp)*size_of, tiny(1.0_wp))
      counts%instants = counts%instants + count(size_of > 0.0_wp)
      counts%above = counts%above + count(max_told > max_above*max_true .and. size_of > 0.0_wp)
      do k = 0, 2
         counts%ratio(k) = counts%ratio(k) + sum(log(max(max_told(:, k), tiny(1.0_wp))/max_true(:, k)), &
            mask=size_of(:, &
            k) > 0.0_wp)
      end do
   end subroutine weigh_instant

   subroutine print_counts(name, t)
      character(*), intent(in) :: name
      type(estimate_counts_t), intent(in) :: t
      character(24) :: field

      field = name
      print '(1x,a,i9,i7,i10,i10,5x,3es9.1,5x,3f9.1)', field, t%numbers, t%below, t%instants, t%above, t%worst, &
         exp(3.0_wp*t%ratio/max(t%instants, 1))
   end subroutine print_counts

   subroutine add(one, sum_of)
      type(estimate_counts_t), intent(in) :: one
      type(estimate_counts_t), intent(inout) :: sum_of

      sum_of%numbers = sum_of%numbers + one%numbers
      sum_of%below = sum_of%below + one%below
      sum_of%instants = sum_of%instants + one%instants
      sum_of%above = sum_of%above + one%above
      sum_of%worst = max(sum_of%worst, one%worst)
      sum_of%ratio = sum_of%ratio + one%ratio
   end subroutine add
end program error_estimates
