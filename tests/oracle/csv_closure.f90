!> Tests. A CSV file of results read back and judged by its deck alone: every row that is due is there, every unmarked
!> row is whole, and positions, velocities and accelerations satisfy the closure equations and the drives in real128.
module csv_closure
   use kinds, only: wp
   use quad_jet, only: qp, jet_t, wrap_angle, operator(-)
   use mechanism, only: mechanism_t, instant_count, request_point, request_pair, pair_prismatic
   use csv_rows, only: rows_t, read_instant, csv_head
   use csv_cells, only: whole_text, blame
   use jet_closure, only: body_jet_t, numbers_of, closure_jets, place_jet, slide_jet
   use jet_drives, only: drive_jets
   use jet_condition, only: condition, sizes_t, sizes_of, row_sizes
   implicit none
   private
   public :: verdict_t, check_csv

   !> Of the size of its numbers, in units of eps: a coordinate is a sum along a chain of up to 20 links, three rounded
   !> terms each; the solver ends with steps of 32 eps.
   real(qp), parameter :: rounding = 64.0_qp*epsilon(1.0_wp)
   !> A deck's own tolerance is one on the last step, which the step itself then betters; METHOD MATRIX may not better
   !> it, and the step may change residuals by as many times itself as a row has numbers.
   real(qp), parameter :: steps_of_tolerance = 16.0_qp
   !> Equations that are too many may contradict one another by this in positions, and by this in rates: so much the
   !> program says that it allows them, and ten times as much for the norm that it measures rates in.
   real(qp), parameter :: contradiction(0:2) = [1.0e-10_qp, 1.0e-7_qp, 1.0e-7_qp]
   !> With a closing tolerance by that, and rates by so many times that and at most a tenth; of the length of a loop,
   !> which is longer than what is in a row.
   real(qp), parameter :: rates_of_closing(0:2) = [1.0_qp, 100.0_qp, 100.0_qp], held_rates = 0.1_qp, &
      shorter_row = 10.0_qp
   !> Beyond this a Jacobian counts as singular in double precision, and no rates are to be told.
   real(qp), parameter :: worst_condition = 1.0e10_qp
   !> Products of numbers near the end of the range lose digits: what is below tiny is nothing.
   real(qp), parameter :: min_size = tiny(1.0_wp)/epsilon(1.0_wp)

   type :: verdict_t
      character(:), allocatable :: text         !< the first thing that is wrong; not allocated: nothing
      integer :: instants = 0, closures = 0     !< instants seen; those with all links, whose closure was computed
      integer :: ill = 0                        !< those whose rates were held to the condition
      real(qp) :: worst(0:2) = 0.0_qp           !< largest residuals in units of what is allowed
   end type verdict_t

contains

   !> Judges the file `path`, results of `sets`.
   subroutine check_csv(path, sets, v)
      character(*), intent(in) :: path
      type(mechanism_t), intent(in) :: sets(:)
      type(verdict_t), intent(out) :: v
      type(rows_t) :: rows
      character(600) :: line
      integer :: unit, status, i, k

      open (newunit=unit, file=path, status='old', action='read', iostat=status)
      if (status == 0) read (unit, '(a)', iostat=status) line
      if (status /= 0) call blame(v%text, 'NO CSV FILE')
      if (status /= 0) return
      if (line /= csv_head) call blame(v%text, 'CSV: ITS HEAD')
      do i = 1, size(sets)
         do k = 0, instant_count(sets(i)) - 1
            call read_instant(unit, sets(i), k, rows, v%text)
            if (.not. allocated(v%text)) call check_instant(sets(i), k, rows, v)
            if (.not. allocated(v%text)) cycle
            v%text = v%text//' (SET '//whole_text(i)//', STEP '//whole_text(k)//')'
            close (unit)
            return
         end do
      end do
      read (unit, '(a)', iostat=status) line
      if (status == 0) call blame(v%text, 'CSV: A ROW TOO MANY')
      close (unit)
   end subroutine check_csv

   subroutine check_instant(m, k, rows, v)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k
      type(rows_t), intent(in) :: rows
      type(verdict_t), intent(inout) :: v
      type(rows_t) :: all_rows

      if (.not. any(rows%due)) return
      v%instants = v%instants + 1
      call check_time(m, k, rows%t, v)
      if (rows%known < 0) return
      all_rows = rows
      call add_blocks(m, all_rows)
      if (all(all_rows%given)) call check_closure(m, all_rows, v)
      call check_rows(m, all_rows, all_rows%body, v)
   end subroutine check_instant

   !> The block of a slot, which has no row, is at the point in the slot and turns with the link that has the slot.
   subroutine add_blocks(m, rows)
      type(mechanism_t), intent(in) :: m
      type(rows_t), intent(inout) :: rows
      type(jet_t) :: p(2)
      integer :: i, carrier, block

      do i = 1, size(m%pairs)
         if (m%pairs(i)%pin == 0) cycle
         carrier = m%points(m%pairs(i)%point_i)%link
         block = m%points(m%pairs(i)%point_j)%link
         rows%given(block) = rows%given(carrier) .and. rows%given(m%points(m%pairs(i)%pin)%link)
         if (.not. rows%given(block)) cycle
         p = place_jet(m, numbers_of(m), rows%body, m%pairs(i)%pin)
         rows%body(block) = body_jet_t(p(1), p(2), rows%body(carrier)%phi)
      end do
   end subroutine add_blocks

   !> t_k = t0 + (t1 - t0) k/n, four roundings; the last and those of AT exactly.
   subroutine check_time(m, k, t, v)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k
      real(wp), intent(in) :: t
      type(verdict_t), intent(inout) :: v
      real(qp) :: wanted, allowed

      allowed = 0.0_qp
      if (k > m%steps) then
         wanted = m%at(k - m%steps)
      else if (k == m%steps) then
         wanted = m%t1
      else
         wanted = m%t0 + (real(m%t1, qp) - m%t0)*k/m%steps
         allowed = 4.0_qp*epsilon(1.0_wp)*max(abs(m%t0), abs(m%t1)) + tiny(1.0_wp)
      end if
      if (.not. abs(t - wanted) <= allowed) call blame(v%text, 'TIME OF THE INSTANT')
   end subroutine check_time

   !> All equations, as far as derivatives are known.
   subroutine check_closure(m, rows, v)
      type(mechanism_t), intent(in) :: m
      type(rows_t), intent(in) :: rows
      type(verdict_t), intent(inout) :: v
      type(jet_t) :: r(2*size(m%pairs) + size(m%drives))
      real(qp) :: share(0:2, size(r)), sizes(0:2, size(r)), allowed(0:2), t
      integer :: k

      v%closures = v%closures + 1
      t = rows%t
      r = closure_jets(m, numbers_of(m), rows%body, drive_jets(m, t))
      share(0, :) = abs(r%v)
      share(1, :) = abs(r%d)
      share(2, :) = abs(r%dd)
      allowed = max(rounding, steps_of_tolerance*m%tolerance)
      sizes = row_sizes(m, sizes_of(m, rows%body), t)
      if (size(r) > 3*count(.not. m%links%ground)) then
         allowed = max(allowed, contradiction)
         if (m%closing > 0.0_wp) allowed = max(allowed, shorter_row*min(m%closing*rates_of_closing, held_rates))
         ! Two guides that ask for angles a whole turn apart ask for the same.
         do k = 1, size(m%pairs)
            if (m%pairs(k)%kind == pair_prismatic) share(0, 2*k) = abs(wrap_angle(r(2*k)%v))
         end do
         ! Two drives that ask for accelerations next to none are told apart by what their rates are worth.
         sizes(2, :) = max(sizes(2, :), sizes(1, :)**2/(sizes(0, :) + min_size))
      end if
      share = share/(spread(allowed, 2, size(r))*(sizes + min_size))
      if (rows%known >= 1) then
         if (any(share(1:rows%known, :) > 1.0_qp)) then
            ! The position, and with it the Jacobian, is known to no better than eps times the condition.
            v%ill = v%ill + 1
            share(1:, :) = share(1:, :)/min(worst_condition, 1.0_qp + condition(m, rows%body))
         end if
      end if
      do k = 0, rows%known
         v%worst(k) = max(v%worst(k), maxval(share(k, :)))
         if (all(share(k, :) <= 1.0_qp)) cycle
         call blame(v%text, trim(what(k))//' OF '//equation(m, maxloc(share(k, :), 1))//': RESIDUAL '// &
            scientific(maxval(share(k, :)))//' OF WHAT IS ALLOWED')
      end do
   end subroutine check_closure

   pure function what(k) result(text)
      integer, intent(in) :: k
      character(12) :: text
      character(12), parameter :: words(0:2) = [character(12) :: 'POSITION', 'VELOCITY', 'ACCELERATION']

      text = words(k)
   end function what

   function equation(m, row) result(text)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: row
      character(:), allocatable :: text

      if (row <= 2*size(m%pairs)) then
         text = 'PAIR '//trim(m%pairs((row + 1)/2)%name)
      else
         text = 'DRIVE '//whole_text(row - 2*size(m%pairs))
      end if
   end function equation

   function scientific(x) result(text)
      real(qp), intent(in) :: x
      character(12) :: text

      write (text, '(es12.3e4)') x
   end function scientific

   !> Rows of points and pairs against those of their links.
   subroutine check_rows(m, rows, body, v)
      type(mechanism_t), intent(in) :: m
      type(rows_t), intent(in) :: rows
      type(body_jet_t), intent(in) :: body(:)
      type(verdict_t), intent(inout) :: v
      type(sizes_t) :: s
      type(jet_t) :: p(2)
      real(qp), allocatable :: d(:)
      integer :: i, j

      s = sizes_of(m, body)
      d = numbers_of(m)
      do i = 1, size(m%requests)
         if (.not. rows%due(i)) cycle
         associate (subject => m%requests(i)%subject)
            if (m%requests(i)%kind == request_point) then
               if (.not. rows%given(m%points(subject)%link)) cycle
               p = place_jet(m, d, body, subject)
               call compare(rows%value(:, i), p, s%length, rows%known, 'POINT '//m%points(subject)%name, v)
            else if (m%requests(i)%kind == request_pair) then
               if (.not. (rows%given(m%points(m%pairs(subject)%point_i)%link) .and. &
                  rows%given(m%points(m%pairs(subject)%point_j)%link))) cycle
               if (m%pairs(subject)%kind == pair_prismatic) then
                  p(1) = slide_jet(m, d, body, subject)
                  call compare(rows%value(:1, i), p(:1), s%length, rows%known, 'SLIDE '//m%pairs(subject)%name, v)
               else
                  j = m%points(m%pairs(subject)%point_j)%link
                  p(1) = body(j)%phi - body(m%points(m%pairs(subject)%point_i)%link)%phi
                  call compare(rows%value(:1, i), p(:1), s%angle, rows%known, 'ANGLE '//m%pairs(subject)%name, v)
               end if
            end if
         end associate
      end do
   end subroutine check_rows

   subroutine compare(found, wanted, sizes, known, name, v)
      type(jet_t), intent(in) :: found(:), wanted(:)
      real(qp), intent(in) :: sizes(0:2)
      integer, intent(in) :: known
      character(*), intent(in) :: name
      type(verdict_t), intent(inout) :: v
      real(qp) :: off(0:2)

      off = [maxval(abs(found%v - wanted%v)), maxval(abs(found%d - wanted%d)), maxval(abs(found%dd - wanted%dd))]
      off = off/(rounding*(sizes + min_size))
      if (any(off(:known) > 1.0_qp)) call blame(v%text, 'ROW OF '//trim(name)//': '//scientific(maxval(off(:known)))// &
         ' OF WHAT IS ALLOWED')
   end subroutine compare
end module csv_closure
