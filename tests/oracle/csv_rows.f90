!> Tests. The rows of one instant read back from a CSV file of results, under the names and in the order that the deck
!> asks for.
module csv_rows
   use kinds, only: wp
   use csv_cells, only: cells, cell_length, split, whole_text, blame
   use quad_jet, only: qp, jet_t, degree_q, constant_jet
   use columns, only: kinds_of_rows
   use mechanism, only: mechanism_t, instant_count, request_link, request_point, request_pair, &
      request_measure, request_pole, pair_prismatic
   use names, only: subject_name
   use jet_closure, only: body_jet_t
   implicit none
   private
   public :: rows_t, read_instant, csv_head

   character(*), parameter :: csv_head = 'set,step,t,kind,name,x,y,phi,vx,vy,vphi,ax,ay,aphi,mark'

   !> What one instant's rows give.
   type :: rows_t
      type(body_jet_t), allocatable :: body(:)  !< (links)
      logical, allocatable :: given(:)          !< (links)
      type(jet_t), allocatable :: value(:, :)   !< (2, requests) of points and pairs
      logical, allocatable :: due(:)            !< (requests)
      integer :: known = 2                      !< derivatives that every row has
      real(wp) :: t = 0.0_wp
      character(12) :: mark = ''
   end type rows_t

contains

   !> The rows of instant `k`, which must be those that the deck asks for.
   subroutine read_instant(unit, m, k, rows, wrong)
      integer, intent(in) :: unit, k
      type(mechanism_t), intent(in) :: m
      type(rows_t), intent(out) :: rows
      character(:), allocatable, intent(inout) :: wrong
      integer :: i
      logical :: is_measure, is_ratio

      rows%given = m%links%ground
      allocate (rows%body(size(m%links)), rows%value(2, size(m%requests)), rows%due(size(m%requests)))
      do i = 1, size(m%links)
         associate (at => m%links(i)%position)
            if (rows%given(i)) rows%body(i) = body_jet_t(constant_jet(real(at(1), qp)), constant_jet(real(at(2), qp)), &
               constant_jet(real(at(3), qp)))
         end associate
      end do
      do i = 1, size(m%requests)
         ! Requests for extremes alone have no rows.
         rows%due(i) = m%requests(i)%every > 0
         if (rows%due(i)) rows%due(i) = mod(k, m%requests(i)%every) == 0 .or. k == instant_count(m) - 1
         rows%due(i) = rows%due(i) .or. m%requests(i)%in_columns
         is_ratio = m%requests(i)%drive > 0
         if (rows%due(i) .and. is_ratio) then
            call pass_number(unit, 'RATIO', subject_name(m, m%requests(i)%kind, m%requests(i)%subject), wrong)
            rows%due(i) = .false.
         end if
         if (rows%due(i) .and. kinds_of_rows(m%requests(i)%kind)%is_centre) then
            call pass_centre(unit, m, i, wrong)
            rows%due(i) = .false.
         end if
         is_measure = rows%due(i) .and. m%requests(i)%kind == request_measure
         if (is_measure) then
            call pass_number(unit, 'MEASURE', m%measures(m%requests(i)%subject)%name, wrong)
            rows%due(i) = .false.
         end if
         if (rows%due(i)) call read_row(unit, m, k, i, rows, wrong)
         if (allocated(wrong)) return
         if ((rows%due(i) .or. is_measure) .and. (allocated(m%tolerances) .or. m%proves .or. (m%assemblies .and. k == 0))) &
            call pass_others(unit)
      end do
   end subroutine read_instant

   !> The three rows of a pole or a curve, request `i`, which have numbers and marks of their own.
   subroutine pass_centre(unit, m, i, wrong)
      integer, intent(in) :: unit, i
      type(mechanism_t), intent(in) :: m
      character(:), allocatable, intent(inout) :: wrong
      character(8), parameter :: kinds(3, 2) = reshape([character(8) :: 'POLE', 'POLE-I', 'POLE-J', &
         'CURVE', 'CENTRE', 'RADIUS'], [3, 2])
      character(600) :: line
      character(cell_length) :: cell(cells)
      integer :: n, k, status

      do n = 1, 3
         read (unit, '(a)', iostat=status) line
         if (status /= 0) call blame(wrong, 'CSV: A ROW IS MISSING')
         if (status /= 0) return
         call split(line, cell, status)
         if (cell(4) /= kinds(n, m%requests(i)%kind - request_pole + 1)) &
            call blame(wrong, 'CSV: '//trim(cell(4))//' IS NOT '//kinds(n, m%requests(i)%kind - request_pole + 1))
         do k = 6, 14
            if (verify(trim(cell(k)), '0123456789+-.E') > 0) &
               call blame(wrong, 'CSV: "'//trim(cell(k))//'" IS NO NUMBER')
         end do
      end do
   end subroutine pass_centre

   !> The row of a measure, whose values `fuzz_mechanisms` compares with those of a known motion, or of a ratio. The name
   !> of a ratio is that of the quantity BY a drive.
   subroutine pass_number(unit, kind, name, wrong)
      integer, intent(in) :: unit
      character(*), intent(in) :: kind, name
      character(:), allocatable, intent(inout) :: wrong
      character(600) :: line
      character(cell_length) :: cell(cells)
      integer :: k, status

      read (unit, '(a)', iostat=status) line
      if (status /= 0 .and. kind /= 'RATIO') call blame(wrong, 'CSV: A ROW IS MISSING')
      if (status /= 0) return
      call split(line, cell, status)
      if (kind == 'RATIO' .and. (cell(4) /= kind .or. index(trim(cell(5))//' BY ', trim(name)//' BY ') /= 1)) then
         ! A drive that does not move the quantity has no row.
         backspace (unit)
         return
      end if
      if (cell(4) /= kind .or. index(trim(cell(5))//' BY ', trim(name)//' BY ') /= 1) &
         call blame(wrong, 'CSV: '//trim(cell(4))//' '//trim(cell(5))//' IS NOT '//kind//' '//trim(name))
      do k = 6, 14
         if (verify(trim(cell(k)), '0123456789+-.E') > 0) call blame(wrong, 'CSV: "'//trim(cell(k))//'" IS NO NUMBER')
      end do
      if (all(cell(6:14) == '') .and. cell(15) == '') call blame(wrong, 'CSV: A '//kind//' WITHOUT VALUE AND MARK')
   end subroutine pass_number

   !> What tolerances make of the row above, its proved bounds, and the same of other assemblies: rows whose kind has
   !> several words.
   subroutine pass_others(unit)
      integer, intent(in) :: unit
      character(600) :: line
      character(cell_length) :: cell(cells)
      integer :: status, count_of

      do
         read (unit, '(a)', iostat=status) line
         if (status /= 0) exit
         call split(line, cell, count_of)
         if (index(trim(cell(4)), ' ') > 0) cycle
         backspace (unit)
         exit
      end do
   end subroutine pass_others

   !> The row of request `i`.
   subroutine read_row(unit, m, k, i, rows, wrong)
      integer, intent(in) :: unit, k, i
      type(mechanism_t), intent(in) :: m
      type(rows_t), intent(inout) :: rows
      character(:), allocatable, intent(inout) :: wrong
      character(600) :: line
      character(cell_length) :: cell(cells)
      type(jet_t) :: value(3)
      integer :: status, known

      read (unit, '(a)', iostat=status) line
      if (status /= 0) call blame(wrong, 'CSV: A ROW IS MISSING')
      if (status /= 0) return
      call split(line, cell, status)
      if (status /= cells) call blame(wrong, 'CSV: NUMBER OF CELLS: '//trim(line))
      if (allocated(wrong)) return
      if (cell(1) /= whole_text(m%set_number) .or. cell(2) /= whole_text(k)) call blame(wrong, &
         'CSV: SET OR STEP: '//trim(line))
      read (cell(3), '(f48.0)', iostat=status) rows%t
      if (status /= 0) call blame(wrong, 'CSV: TIME: '//trim(line))
      rows%mark = cell(15)(:12)
      ! An instant out of a stroke is complete.
      if (rows%mark == 'STROKE') rows%mark = ''
      if (all(rows%mark /= [character(12) :: '', 'NO-POSITION', 'NO-RATES', 'TOO-LARGE', 'OPEN', 'UNKNOWN'])) &
         call blame(wrong, 'CSV: MARK: '//trim(line))
      call read_values(m, i, cell(6:14), rows%mark == 'UNKNOWN', value, known, wrong)
      rows%known = min(rows%known, known)
      if ((rows%mark == '') .neqv. (known == 2)) call blame(wrong, 'CSV: KNOWN VALUES AND MARK: '//trim(line))
      if (allocated(wrong)) return
      call keep_row(m, i, cell(4), cell(5), value, known, rows, wrong)
   end subroutine read_row

   !> A row, of so many derivatives `known`, under the name that it must have.
   subroutine keep_row(m, i, kind, name, value, known, rows, wrong)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i, known
      character(*), intent(in) :: kind, name
      type(jet_t), intent(in) :: value(3)
      type(rows_t), intent(inout) :: rows
      character(:), allocatable, intent(inout) :: wrong
      character(8) :: wanted(2)

      associate (subject => m%requests(i)%subject)
         select case (m%requests(i)%kind)
         case (request_link)
            wanted = [character(8) :: 'LINK', m%links(subject)%name]
            rows%body(subject) = body_jet_t(value(1), value(2), value(3))
            rows%given(subject) = known >= 0
         case (request_point)
            wanted = [character(8) :: 'POINT', m%points(subject)%name]
            rows%value(:, i) = value(:2)
         case default
            wanted = [character(8) :: 'PAIR', m%pairs(subject)%name]
            rows%value(:, i) = value(:2)
         end select
      end associate
      if (kind /= wanted(1) .or. name /= wanted(2)) call blame(wrong, &
         'CSV: '//trim(kind)//' '//trim(name)//' IS NOT '// &
         trim(wanted(1))//' '//trim(wanted(2)))
   end subroutine keep_row

   !> The numbers of request `i` as jets, angles in radians; `known`: derivatives that are there, -1 for not even
   !> places.
   subroutine read_values(m, i, cell, unknown, value, known, wrong)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i
      character(*), intent(in) :: cell(9)
      logical, intent(in) :: unknown
      type(jet_t), intent(out) :: value(3)
      integer, intent(out) :: known
      character(:), allocatable, intent(inout) :: wrong
      real(wp) :: x
      real(qp) :: number(3, 0:2)
      logical :: there(3, 0:2), angular
      integer :: c, k, columns, status

      columns = 3
      if (m%requests(i)%kind == request_point) columns = 2
      if (m%requests(i)%kind == request_pair) columns = 1
      angular = .false.
      if (columns == 1) angular = m%pairs(m%requests(i)%subject)%kind /= pair_prismatic
      number = 0.0_qp
      there = reshape(cell /= '', [3, 3])
      do k = 0, 2
         do c = 1, 3
            if (.not. there(c, k)) cycle
            read (cell(3*k + c), '(f48.0)', iostat=status) x
            if (status /= 0 .or. verify(trim(cell(3*k + c)), '0123456789+-.E') > 0) &
               call blame(wrong, 'CSV: "'//trim(cell(3*k + c))//'" IS NO NUMBER')
            number(c, k) = x
            if (m%degrees .and. (c == 3 .or. angular)) number(c, k) = degree_q*number(c, k)
         end do
      end do
      known = count(there(1, :)) - 1
      if (unknown) known = findloc([(all(there(:columns, k)), k=0, 2)], .false., dim=1) - 2
      if (.not. all(there(:columns, :known)) .or. (any(there(:, known + 1:)) .and. .not. unknown) &
         .or. any(there(columns + 1:, :))) call blame(wrong, 'CSV: CELLS THAT ARE FULL')
      value%v = number(:, 0)
      value%d = number(:, 1)
      value%dd = number(:, 2)
   end subroutine read_values
end module csv_rows
