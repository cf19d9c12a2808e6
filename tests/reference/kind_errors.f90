!> Tests. `kind_errors DECK...`: how good the results of a build are, whatever kind of real it has. Beside each deck
!> lies the CSV file that `kinmat --csv` wrote, with all links that move at all instants.
!>
!> The results must satisfy the equations of the deck as its reader understood it, derivatives included; and they must
!> be those of the closed forms, and, where motions are known to 50 digits, those. Printed for each set: the largest
!> errors of positions, velocities and accelerations, of lengths and of angles, relative to the largest such value of
!> the set, or to what the deck's characteristic length and rate make of it where that is larger. The last line is `N
!> passed, N failed`.
program kind_errors
   use kinds, only: wp
   use failures, only: failure_t
   use mechanism, only: mechanism_t, instant_count
   use scales, only: characteristic_length, characteristic_rate
   use deck, only: read_deck
   use quad_jet, only: qp, degree_q, wrap_angle
   use closed_forms_dyads, only: body_t, motion_of
   use test_counter, only: test_counter_t, count_one, conclude, deck_name
   use closed_forms, only: closed_form
   use csv_cells, only: cells, cell_length, split
   use csv_closure, only: verdict_t, check_csv
   use fifty_digits, only: known
   implicit none
   !> Errors allowed: an equation is known to so many roundings of its six terms and of what is on the cards, a position
   !> to |J^-1| times that, velocities and accelerations to |J^-1| more each. |J^-1| is below 10 in the unit of length,
   !> and below 27 within 5 deg of a change point, where it has no inverse. For real128 this is 1e-32, 1e-31 and 1e-30.
   !> At the distance g from a dead point, sqrt(g/3) of the crank's angle, it is of the order of 3/sqrt(g).
   real(qp), parameter :: roundings = 5.0_qp, inverse = 10.0_qp, inverse_close = 27.0_qp
   character(*), parameter :: dead_sets(3) = [character(16) :: 'dead_point_6, 1', 'dead_point_9, 1', 'dead_point_12, 1']
   real(qp), parameter :: inverse_dead(3) = [1.8e3_qp, 5.5e4_qp, 1.8e6_qp]
   character(*), parameter :: close_sets(8) = [character(27) :: 'antiparallelogram_across, 1', 'kite_across, 1', &
      'parallelogram, 1', 'scott_russell, 1', 'antiparallelogram_branch, 1', 'kite_branch, 1', &
      'parallelogram_branch, 1', 'scott_russell_branch, 1']
   !> At a change point itself the position is the place where the Jacobian has no inverse, which is known as positions
   !> close to it are; there are no velocities. In few bits that place is not always found: any position whose equations
   !> hold up to rounding is then within the root of that.
   character(*), parameter :: at_change(4) = [character(20) :: 'antiparallelogram_at', 'kite_at', 'parallelogram_at', &
      'scott_russell_at']
   !> Sets whose cards hold pi/2, a root and the like in 16 or 17 digits, where the closed forms have the number itself:
   !> real128 tells them apart. None of them multiplies that by more than a few.
   character(*), parameter :: rounded_sets(7) = [character(14) :: 'andrews, 2', 'drag_link, 1', 'drag_link, 2', &
      'jansen, 1', &
      'scotch_yoke, 2', 'trammel, 2', 'two_loops, 1']
   real(qp), parameter :: rounded_data = 5.0e-16_qp
   !> Below this number of bits it depends on the last one whether the way on from a change point is known: instants of
   !> decks with such names may be marked, which is no error; what is given is compared like all else. Of a crank that
   !> has turned often no digit is left then; of an acceleration that is a difference of 1E-12 of two, none by the
   !> estimate.
   integer, parameter :: bits_enough = 53
   real(qp), parameter :: roundings_there = merge(roundings*inverse_close, sqrt(roundings/epsilon(1.0_wp)), &
      digits(1.0_wp) >= bits_enough)
   character(*), parameter :: change_decks(3) = [character(7) :: '_across', '_at', '_branch']

   !> (x or y, angle; derivative): largest error and largest value.
   type :: errors_t
      real(qp) :: error(2, 0:2) = 0.0_qp, value(2, 0:2) = 0.0_qp
      logical, allocatable :: seen(:, :)      !< (links, instants): compared
      logical :: all_given = .true.           !< no row without a value
      real(qp) :: there = 0.0_qp              !< largest error of a position at a change point, of lengths and angles
   end type errors_t

   character(500) :: path
   type(test_counter_t) :: counter
   integer :: hits = 0, i

   print '(a,i0,a)', ' LARGEST RELATIVE ERRORS OF LENGTHS AND ANGLES, COMPUTED WITH ', digits(1.0_wp), ' BITS'
   print '(a)', ' DECK, SET                     POSITION    VELOCITY  ACCELERAT.    LIMITS'
   do i = 1, command_argument_count()
      call get_command_argument(i, path)
      call check_deck(trim(path))
   end do
   call count_one(counter, hits == size(known), 'all motions known to 50 digits')
   call conclude(counter)

contains

   subroutine check_deck(path)
      character(*), intent(in) :: path
      character(:), allocatable :: name, report
      character(1000) :: line
      type(mechanism_t), allocatable :: sets(:)
      type(failure_t), allocatable :: failure
      type(errors_t), allocatable :: e(:)
      type(verdict_t) :: v
      integer :: i, unit, status

      name = deck_name(path)
      call read_deck(path, sets, report, failure)
      call count_one(counter, .not. allocated(failure), path//': the deck is read')
      if (allocated(failure)) return
      associate (csv => path(:len(path) - len('deck'))//'csv')
         call check_csv(csv, sets, v)
         if (.not. allocated(v%text)) v%text = ''
         call count_one(counter, v%text == '', name//': equations: '//v%text)
         open (newunit=unit, file=csv, status='old', action='read', iostat=status)
      end associate
      allocate (e(size(sets)))
      do i = 1, size(sets)
         allocate (e(i)%seen(size(sets(i)%links), 0:instant_count(sets(i)) - 1))
         e(i)%seen = spread(sets(i)%links%ground .or. sets(i)%links%hidden, 2, instant_count(sets(i)))
      end do
      do while (status == 0)
         read (unit, '(a)', iostat=status) line
         if (status == 0) call compare_row(line, name, sets, e)
      end do
      close (unit)
      do i = 1, size(sets)
         call judge(name, sets(i), e(i))
      end do
   end subroutine check_deck

   subroutine judge(name, m, e)
      character(*), intent(in) :: name
      type(mechanism_t), intent(in) :: m
      type(errors_t), intent(inout) :: e
      character(30) :: what
      real(qp) :: limit(0:2), worst(0:2)
      integer :: k

      write (what, '(1x,2a,i0)') name, ', ', m%set_number
      if (digits(1.0_wp) >= bits_enough .or. .not. has_change(name)) &
         call count_one(counter, e%all_given .and. all(e%seen), what//' all moving links at all instants')
      call count_one(counter, any(e%seen .and. .not. spread(m%links%ground, 2, instant_count(m))), what//' some results')
      do k = 0, 2
         associate (rate => real(characteristic_rate(m, characteristic_length(m)), qp)**k)
            e%value(:, k) = max(e%value(:, k), [characteristic_length(m)*rate, rate])
         end associate
         worst(k) = maxval(e%error(:, k)/e%value(:, k))
      end do
      limit = limits(inverse)
      if (any(close_sets == what(2:))) limit = limits(inverse_close)
      k = findloc(dead_sets == what(2:), .true., dim=1)
      if (k > 0) limit = limits(inverse_dead(k))
      if (any(rounded_sets == what(2:))) limit = max(limit, rounded_data)
      print '(a,3es12.2,2x,3es10.1)', what, worst, limit
      call count_one(counter, all(worst <= limit), what//' errors')
      if (all(at_change /= name)) return
      print '(a,es12.2,26x,es10.1)', what, e%there, roundings_there*epsilon(1.0_wp)*maxval(e%value(:, 0))
      call count_one(counter, e%there <= roundings_there*epsilon(1.0_wp)*maxval(e%value(:, 0)), &
         what//' errors at change points')
   end subroutine judge

   !> The deck's mechanism passes a change point, or stands in one.
   pure logical function has_change(name)
      character(*), intent(in) :: name
      integer :: i

      has_change = any([(index(name, trim(change_decks(i)), back=.true.) > 0, i=1, size(change_decks))])
   end function has_change

   !> (derivative) Of a Jacobian with so large an inverse.
   pure function limits(inverse)
      real(qp), intent(in) :: inverse
      real(qp) :: limits(0:2)

      limits = roundings*epsilon(1.0_wp)*[inverse, inverse**2, inverse**3]
   end function limits

   !> One row of results, if it is a link's.
   subroutine compare_row(line, name, sets, e)
      character(*), intent(in) :: line, name
      type(mechanism_t), intent(in) :: sets(:)
      type(errors_t), intent(inout) :: e(:)
      character(cell_length) :: cell(cells)
      type(body_t), allocatable :: links(:)
      real(qp) :: value(3, 0:2), t
      integer :: i, k, link, at

      call split(line, cell, i)
      if (cell(4) /= 'LINK') return
      read (cell(1:2), *) i, k
      ! An instant out of a stroke is complete.
      if (cell(15) == 'STROKE') cell(15) = ''
      if (any(at_change == name) .and. cell(15) == 'NO-RATES') cell(9:) = '0.0'
      link = findloc(sets(i)%links%name == cell(5), .true., dim=1)
      if (cell(15) == 'UNKNOWN' .and. (digits(1.0_wp) < bits_enough .or. name == 'dead_point_12')) then
         e(i)%seen(link, k) = .true.
         return
      end if
      if (any(cell(6:14) == '') .or. (cell(15) /= '' .and. cell(15) /= '0.0')) then
         e(i)%all_given = .false.
         return
      end if
      read (cell(3), *) t
      read (cell(6:14), *) value
      if (sets(i)%degrees) value(3, :) = value(3, :)*degree_q
      links = closed_form(name, i, t)
      at = findloc(links%name == cell(5), .true., dim=1)
      if (at == 0) return
      if (cell(15) == '') then
         call compare(value, links(at), e(i))
      else
         call compare_place(value(:, 0), links(at), e(i))
      end if
      e(i)%seen(link, k) = .true.
      call compare_known(name, i, k, cell(5), value)
   end subroutine compare_row

   !> Against what is known to 50 digits, relative to the value or to 1.
   subroutine compare_known(name, set, step, link, value)
      character(*), intent(in) :: name, link
      integer, intent(in) :: set, step
      real(qp), intent(in) :: value(3, 0:2)
      real(qp) :: off(3, 0:2), allowed(3, 0:2)
      integer :: i

      do i = 1, size(known)
         if (known(i)%deck /= name .or. known(i)%link /= link) cycle
         if (known(i)%set /= set .or. known(i)%step /= step) cycle
         off = value - reshape(known(i)%value, [3, 3])
         off(3, 0) = wrap_angle(off(3, 0))
         allowed = spread(limits(inverse), 1, 3)*max(1.0_qp, abs(reshape(known(i)%value, [3, 3])))
         hits = hits + 1
         call count_one(counter, all(abs(off) <= allowed), name//': 50 digits')
      end do
   end subroutine compare_known

   !> The position alone.
   subroutine compare_place(value, exact, e)
      real(qp), intent(in) :: value(3)
      type(body_t), intent(in) :: exact
      type(errors_t), intent(inout) :: e
      real(qp) :: off(3)

      off = value - [exact%x%v, exact%y%v, exact%phi%v]
      e%there = max(e%there, maxval(abs([off(:2), wrap_angle(off(3))])))
   end subroutine compare_place

   subroutine compare(value, exact, e)
      real(qp), intent(in) :: value(3, 0:2)
      type(body_t), intent(in) :: exact
      type(errors_t), intent(inout) :: e
      real(qp) :: right(3, 0:2), off(3, 0:2)

      right = motion_of(exact)
      right(3, 0) = value(3, 0) + wrap_angle(right(3, 0) - value(3, 0))
      off = abs(value - right)
      e%error(1, :) = max(e%error(1, :), off(1, :), off(2, :))
      e%error(2, :) = max(e%error(2, :), off(3, :))
      e%value(1, :) = max(e%value(1, :), abs(right(1, :)), abs(right(2, :)))
      e%value(2, :) = max(e%value(2, :), abs(right(3, :)))
   end subroutine compare
end program kind_errors
