!> The finished rows of a set at one instant, in the order of the cards: all that writers see of a motion. Only this
!> module knows in which part of the set a row is, its request, the estimates of its errors and its sensitivities.
module rows
   use assertions, only: asserts, assert
   use kinds, only: wp
   use columns, only: columns_of_rows, forms, kinds_of_rows, row_turning, is_ratio, usual_size
   use points, only: row_t, find_row, is_printed
   use assemblies, only: assemblies_t
   use error_estimate, only: estimate_of, row_error
   use sensitivities, only: has_tolerances
   use set_motion, only: set_motion_t, find_row_of_position
   use number_format, only: whole
   use mechanism, only: tolerance_t
   implicit none
   private
   public :: finished_row_t, find_rows, word_worst, word_rss

   !> A further row of a request: the effect of tolerances, or the row in another assembly.
   type :: other_row_t
      character(56) :: word = ''             !< WORST, RSS, PER and a number, or ASSEMBLY and its number
      type(row_t) :: row
      real(wp) :: doubt(3, 0:2) = 0.0_wp     !< of tolerances: the rounding error of the value, in the units of `row`
   end type other_row_t

   !> The words of the further rows by tolerances: their worst case, and the root of the sum of their squares.
   character(*), parameter :: word_worst = 'WORST', word_rss = 'RSS'

   !> A row, and what its printed digits and its further rows need. Errors have the units of the value.
   type, extends(row_t) :: finished_row_t
      integer :: part = 1                    !< the independent mechanism whose digits it has
      integer :: shown = 0                   !< the form of the row in the listing: row_link, ...
      logical :: listed = .false.            !< the row is in the listing
      logical :: due = .false.               !< the row is in the CSV and the table
      logical :: may_lose_digits = .false.          !< some digit may be in doubt: `doubt` is estimated
      real(wp) :: doubt(3, 0:2) = 0.0_wp     !< the rounding error of the value; 0 without an estimate
      real(wp) :: error(3, 0:2) = 0.0_wp     !< the estimated error of the value, if errors are asked for
      logical :: has_digit(3, 0:2) = .true.  !< at least one digit of the number is known
      type(other_row_t), allocatable :: others(:)   !< WORST, RSS and one for each tolerance; then ASSEMBLY. Or none
   end type finished_row_t

contains

   !> Finds the rows of an instant, and which of them are printed. Rows that are not printed keep their old values,
   !> unless all are wanted. Errors and sensitivities are as `sample_set` has left them.
   subroutine find_rows(motions, assemblies, step, all_of_them, rows)
      type(set_motion_t), intent(in) :: motions   !< at the instant
      type(assemblies_t), allocatable, intent(in) :: assemblies(:)   !< (parts) at the first instant, if asked for
      integer, intent(in) :: step            !< the number of the instant, from 0
      logical, intent(in) :: all_of_them     !< also those that are not printed at this instant
      type(finished_row_t), allocatable, intent(inout) :: rows(:)   !< (requests of the set)
      logical :: is_here
      integer :: i

      if (asserts) call assert(step >= 0, 'find_rows: number of an instant')
      if (.not. allocated(rows)) allocate (rows(size(motions%rows)))
      do i = 1, size(rows)
         associate (row => rows(i), c => motions%rows(i)%part, n => motions%rows(i)%number)
            associate (m => motions%parts(c), request => motions%parts(c)%requests(n), errors => motions%errors(c))
               is_here = is_printed(motions, request, step)
               row%due = is_here .or. request%in_columns
               row%listed = is_here .or. request%listed
               if (.not. (row%listed .or. row%due .or. all_of_them)) cycle
               row%part = c
               call find_row(m, motions%motions(c), request, row%row_t)
               row%shown = merge(row_turning, row%form, request%angle_alone)

               ! The initial values hold until the first estimate.
               if (row%may_lose_digits) then
                  row%doubt = 0.0_wp
                  row%has_digit = .true.
               end if
               row%may_lose_digits = errors%taken .and. errors%may_lose_digits
               if (row%may_lose_digits) then
                  row%doubt = estimate_of(row%row_t, m, errors, n)
                  call find_digits(row, errors%sizes%length, errors%sizes%rate, m%degrees)
               end if
               if (errors%asked) row%error = row_error(m, errors, motions%motions(c), n)

               if (allocated(row%others)) deallocate (row%others)
               if (.not. (allocated(m%tolerances) .or. (allocated(assemblies) .and. step == 0))) cycle
               ! Rows with three lines in the CSV have no others, and ratios have none.
               if (kinds_of_rows(row%kind)%rows == 1 .and. .not. is_ratio(row%form)) &
                  call find_others(row, motions, i, step, assemblies)
            end associate
         end associate
      end do
   end subroutine find_rows

   !> Finds which numbers of a row have a known digit: the error is at most a tenth of the number, or of a usual one if
   !> that is larger.
   pure subroutine find_digits(row, length, rate, degrees)
      type(finished_row_t), intent(inout) :: row   !< with `doubt`; gets `has_digit`
      real(wp), intent(in) :: length         !< characteristic length of the mechanism
      real(wp), intent(in) :: rate           !< characteristic rate of the mechanism, 1 over the unit of time
      logical, intent(in) :: degrees         !< the deck's unit of angles
      integer :: j

      do j = forms(row%form)%first, forms(row%form)%last
         associate (column => columns_of_rows(j), c => columns_of_rows(j)%at(1), k => columns_of_rows(j)%at(2))
            row%has_digit(c, k) = .not. 10.0_wp*row%doubt(c, k) > max(abs(row%value(c, k)), &
               usual_size(column%dimension, column%order, length, rate, degrees))
         end associate
      end do
   end subroutine find_digits

   !> Finds the further rows of a row: the effect of tolerances, and its value in each assembly at the first instant.
   !> A row without tolerances, and with assemblies not asked for or a later instant, gets an empty list.
   subroutine find_others(row, motions, i, step, assemblies)
      type(finished_row_t), intent(inout) :: row   !< gets `others`
      type(set_motion_t), intent(in) :: motions   !< at the instant
      integer, intent(in) :: i               !< the row's number among the requests of the set
      integer, intent(in) :: step            !< the number of the instant, from 0
      type(assemblies_t), allocatable, intent(in) :: assemblies(:)   !< (parts) at the first instant, if asked for
      integer :: k

      allocate (row%others(0))
      associate (c => motions%rows(i)%part, n => motions%rows(i)%number)
         if (has_tolerances(motions%parts(c), motions%parts(c)%requests(n)) .and. motions%sensitivities(c)%taken) then
            associate (found => motions%sensitivities(c), tolerances => motions%parts(c)%tolerances)
               call add(word_worst, worst_case(tolerances, found%of(:, :, :, n)), &
                  worst_case(tolerances, found%error(:, :, :, n)))
               ! The difference of two roots is no larger than the root of the differences.
               call add(word_rss, root_of_squares(tolerances, found%of(:, :, :, n)), &
                  root_of_squares(tolerances, found%error(:, :, :, n)))
               do k = 1, size(tolerances)
                  call add('PER '//trim(tolerances(k)%name), found%of(:, :, k, n), found%error(:, :, k, n))
               end do
               row%others%row%known = found%known(n)
            end associate
         end if

         if (.not. allocated(assemblies) .or. step > 0) return
         do k = 1, size(assemblies(c)%list)
            row%others = [row%others, other_row_t('ASSEMBLY '//whole(k))]
            call find_row_of_position(motions, i, assemblies(c)%list(k)%position, row%others(size(row%others))%row)
         end do
      end associate

   contains

      !> Adds a row with the name and the form of `row`.
      subroutine add(word, value, doubt)
         character(*), intent(in) :: word    !< of `other_row_t`: WORST, ...
         real(wp), intent(in) :: value(3, 0:2)   !< in the deck's units and radians
         real(wp), intent(in) :: doubt(3, 0:2)   !< the rounding error of `value`
         type(other_row_t) :: one

         one%word = word
         one%row = row%row_t
         one%row%value = value
         one%doubt = doubt
         row%others = [row%others, one]
      end subroutine add
   end subroutine find_others

   !> Gives the largest change (3, 0:2) of a row that tolerances allow, in the units of the row: the sum of all changes.
   pure function worst_case(tolerances, changes) result(x)
      type(tolerance_t), intent(in) :: tolerances(:)   !< (numbers)
      real(wp), intent(in) :: changes(:, 0:, :)   !< (3, 0:2, numbers) sensitivities of the row, or their errors
      real(wp) :: x(3, 0:2)
      integer :: d

      x = 0.0_wp
      do d = 1, size(tolerances)
         x = x + abs(changes(:, :, d))*tolerances(d)%size_of
      end do
   end function worst_case

   !> Gives the root (3, 0:2) of the sum of the squares of the changes of a row, each by one tolerance, in the units of
   !> the row.
   pure function root_of_squares(tolerances, changes) result(x)
      type(tolerance_t), intent(in) :: tolerances(:)   !< (numbers)
      real(wp), intent(in) :: changes(:, 0:, :)   !< (3, 0:2, numbers) sensitivities of the row, or their errors
      real(wp) :: x(3, 0:2)
      integer :: c, k

      do k = 0, 2
         do c = 1, 3
            x(c, k) = norm2(changes(c, k, :)*tolerances%size_of)
         end do
      end do
   end function root_of_squares
end module rows
