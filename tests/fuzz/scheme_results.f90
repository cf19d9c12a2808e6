!> Tests. The results of schemes, read back from a CSV file with errors, against their true motion: every number by the
!> error that the program tells of it, and every flag.
module scheme_results
   use, intrinsic :: iso_fortran_env, only: real64
   use quad_jet, only: qp, jet_t, pi_q, operator(-), operator(+), operator(*), sin, cos, sqrt, atan2
   use schemes, only: scheme_t, form_parallelogram, angle_unit, link_at, place, is_redundant
   use mechanism, only: measure_distance, measure_line, measure_angle, measure_xi, measure_sum
   use csv_cells, only: cell_length, split, blame
   use scheme_motion, only: motion_t, begin_motion, move_to, closes, is_followed, is_lost
   implicit none
   private
   public :: verdict_t, judge

   !> The error of a number may be so many times what the program tells of it, which is a matter of chance: of 2.5
   !> million numbers two were off by more than that, by 1.2 times as much.
   real(qp), parameter :: of_told = 3.0_qp
   !> The last bits of a number.
   real(qp), parameter :: bits = 4.0_qp*epsilon(1.0_real64)
   !> Of what is fixed it tells no errors: this part of a number.
   real(qp), parameter :: untold = 1.0e-8_qp
   !> A number that is zero, of the size of its mechanism.
   real(qp), parameter :: nothing = max(1.0e-20_qp, 256*epsilon(1.0_qp))
   !> The square of a distance from a singularity down to which flags are needless, all the way from the first instant.
   real(qp), parameter :: safe_margin = 1.0e-4_qp
   !> The sine of the angle from a change point up to which there may be no velocities.
   real(qp), parameter :: beside_change = 1.0e-4_qp
   !> The one matrix of METHOD DENSE, or of redundant equations, may have no velocities for a group that is smaller than
   !> this part of another one; where they end, so does the motion that is followed.
   real(qp), parameter :: small_group = 0.01_qp
   !> Points that are closer, in lengths of their mechanism, may coincide: their direction is not compared.
   real(qp), parameter :: close = 1.0e-6_qp
   !> Of a row with errors.
   integer, parameter :: cells = 24

   type :: row_t
      integer :: set = 0, step = 0, number = 0
      character(1) :: kind = ''                !< L, P, K or M
      real(qp) :: t = 0.0_qp
      real(qp) :: value(9) = 0.0_qp, error(9) = 0.0_qp
      logical :: known(9) = .false., is_told(9) = .false.
      character(12) :: mark = ''
   end type row_t

   !> Of each group (groups), up to now.
   type :: so_far_t
      logical, allocatable :: found(:)         !< had positions wherever one was asked for
      logical, allocatable :: begun(:)         !< are followed: at the first instant they had velocities
      logical, allocatable :: told(:)          !< errors were told of all its numbers: otherwise nothing is known of
                                               !< them, as behind dyads much smaller than what moves them
   end type so_far_t

   type :: verdict_t
      character(:), allocatable :: text        !< the first thing that is wrong
      integer :: instants = 0, numbers = 0     !< compared
      integer :: lost = 0, unknown = 0         !< rows beyond a limit; of groups whose reference is not known
      integer :: flagged = 0                   !< rows flagged that have a reference, not far from a singularity
      integer :: above = 0                     !< numbers that are off by more than the error told
      real(qp) :: worst(0:2) = 0.0_qp          !< largest errors, in units of what is allowed
   end type verdict_t

contains

   !> Judges the file `path`, the results of `s`. `is_too_long`: the listing says of a motion that it takes more
   !> substeps than are tried.
   subroutine judge(s, path, is_too_long, v)
      type(scheme_t), intent(in) :: s(:)
      character(*), intent(in) :: path
      logical, intent(in) :: is_too_long
      type(verdict_t), intent(inout) :: v
      type(row_t) :: row
      type(motion_t) :: m, regular
      integer :: unit, status, set, step
      type(so_far_t) :: so_far
      logical :: at_end

      open (newunit=unit, file=path, status='old', action='read', iostat=status)
      if (status == 0) read (unit, '(a)', iostat=status)
      if (status /= 0) call blame(v%text, 'NO CSV FILE')
      set = 0
      step = -1
      do while (.not. allocated(v%text))
         call read_row(unit, row, at_end, v)
         if (at_end .or. allocated(v%text)) exit
         if (row%set /= set .or. row%step /= step) call begin_instant(s, row, set, step, m, regular, so_far, v)
         if (.not. allocated(v%text)) call judge_row(s(set), m, row, is_too_long, so_far, v)
      end do
      close (unit)
      if (set /= size(s)) call blame(v%text, 'SETS ARE MISSING')
   end subroutine judge

   !> The motion `m` at the instant of `row`, `regular` the last one of all groups.
   subroutine begin_instant(s, row, set, step, m, regular, so_far, v)
      type(scheme_t), intent(in) :: s(:)
      type(row_t), intent(in) :: row
      integer, intent(inout) :: set, step
      type(motion_t), intent(inout) :: m, regular
      type(so_far_t), intent(inout) :: so_far
      type(verdict_t), intent(inout) :: v
      character(:), allocatable :: problem
      integer :: k

      step = row%step
      if (row%set /= set) then
         set = row%set
         if (set < 1 .or. set > size(s)) call blame(v%text, 'NUMBER OF THE SET')
         if (allocated(v%text)) return
         call begin_motion(s(set), row%t, m, problem)
         if (allocated(problem)) call blame(v%text, 'THE REFERENCE: '//problem)
         if (allocated(problem)) return
         regular = m
         so_far%found = [(.true., k=1, size(s(set)%groups))]
         so_far%told = so_far%found
         so_far%begun = so_far%found
      end if
      ! Beyond a limit nothing is lost for an instant before it.
      if (size(s(set)%at) > 0) m = regular
      call move_to(s(set), row%t, m)
      if (all(m%status == regular%status)) regular = m
      v%instants = v%instants + 1
      if (.not. closes(s(set), m)) call blame(v%text, 'THE REFERENCE DOES NOT CLOSE AT '//where(row))
   end subroutine begin_instant

   !> A row against the motion `m`. After an instant without a position METHOD MATRIX may find another assembly, from
   !> the deck's estimate, and says so: no limit keeps it from that.
   subroutine judge_row(s, m, row, is_too_long, so_far, v)
      type(scheme_t), intent(in) :: s
      type(motion_t), intent(in) :: m
      type(row_t), intent(in) :: row
      logical, intent(in) :: is_too_long
      type(so_far_t), intent(inout) :: so_far
      type(verdict_t), intent(inout) :: v
      type(jet_t) :: reference(3)
      real(qp) :: scale, unit(3), per_unit
      integer, allocatable :: group(:)
      integer :: status

      group = groups_of(s, row)
      if (any(group > 0)) status = maxval(m%status(pack(group, group > 0)))
      if (.not. any(group > 0)) status = is_followed
      if (status == is_lost) then
         v%lost = v%lost + 1
         if (row%known(1) .and. .not. (s%method == 'MATRIX' .and. .not. so_far%found(maxval(group)))) &
            call blame(v%text, 'A POSITION BEYOND A LIMIT: '//where(row))
         return
      else if (status /= is_followed) then
         v%unknown = v%unknown + 1
         return
      end if
      if (any(group > 0)) then
         ! Without them the next instant is found from the deck's estimate, as the first one was.
         if (.not. so_far%begun(maxval(group))) then
            v%unknown = v%unknown + 1
            return
         end if
      end if
      ! Where two points are close, digits of their direction are lost, and there may be no direction.
      if (row%mark /= '' .and. &
         .not. (row%kind == 'M' .and. any(row%mark == [character(12) :: 'COINCIDE', 'UNKNOWN']))) &
         call judge_flag(s, m, group, row, is_too_long, so_far, v)
      if (any(group > 0) .and. row%kind /= 'M') then
         associate (k => maxval(group))
            if (row%mark == 'NO-RATES' .and. row%step == 0) so_far%begun(k) = .not. may_miss(s)
            so_far%told(k) = so_far%told(k) .and. .not. any(row%known .and. .not. row%is_told)
            so_far%found(k) = so_far%found(k) .and. row%known(1)
            if (s%method == 'MATRIX' .and. .not. so_far%found(k)) then
               v%unknown = v%unknown + 1
               return
            end if
         end associate
      end if
      reference = true_values(s, m, row)
      if (row%kind == 'M') then
         if (.not. reference(3)%v > 0.0_qp) then
            v%unknown = v%unknown + 1
            return
         end if
         ! The turns of a direction are another matter.
         per_unit = 1.0_qp/angle_unit(s)
         if (s%measures(row%number)%is_angle) reference(1)%v = reference(1)%v &
            + 2.0_qp*pi_q*per_unit*anint((row%value(1) - reference(1)%v)/(2.0_qp*pi_q*per_unit))
         reference(2:) = jet_t()
      end if
      ! Of a point of the ground the sum of its own numbers is rounded, and no error is told.
      scale = 1.0_qp
      if (row%kind == 'P') scale = (norm2(s%links(link_at(s, row%number))%at(:2)) &
         + norm2(s%points(row%number)%offset))*bits/nothing
      if (row%kind == 'M' .and. .not. any(group > 0)) scale = maxval(s%groups%scale)
      if (any(group > 0)) scale = maxval(s%groups(pack(group, group > 0))%scale)
      unit = [scale, scale, 1.0_qp/angle_unit(s)]
      call compare(reference%v, row, 0, unit, any(group > 0) .or. row%kind == 'M', v)
      if (.not. any(group > 0)) return
      call compare(reference%d, row, 1, unit/s%span, .true., v)
      call compare(reference%dd, row, 2, unit/s%span**2, .true., v)
   end subroutine judge_row

   !> Numbers of derivative `k`, as far as they are there; `unit`: their size. Where it `moves` an error that
   !> is not told says that nothing is known of the number.
   subroutine compare(reference, row, k, unit, moves, v)
      real(qp), intent(in) :: reference(3), unit(3)
      type(row_t), intent(in) :: row
      integer, intent(in) :: k
      logical, intent(in) :: moves
      type(verdict_t), intent(inout) :: v
      real(qp) :: off, allowed
      integer :: c, i

      do c = 1, 3
         i = 3*k + c
         if (.not. row%known(i) .or. (moves .and. .not. row%is_told(i))) cycle
         v%numbers = v%numbers + 1
         allowed = of_told*row%error(i) + bits*abs(reference(c)) + nothing*unit(c)
         if (.not. row%is_told(i)) allowed = untold*max(abs(reference(c)), unit(c))
         off = abs(row%value(i) - reference(c))/max(allowed, tiny(allowed))
         if (row%is_told(i) .and. abs(row%value(i) - reference(c)) > row%error(i) + bits*abs(reference(c)) &
            + nothing*unit(c)) v%above = v%above + 1
         v%worst(k) = max(v%worst(k), off)
         if (.not. off <= 1.0_qp) call blame(v%text, 'COLUMN '//achar(iachar('0') + i)//' OF '//where(row)//': '// &
            told(row%value(i))//' FOR '//told(reference(c))//', ERROR TOLD '//told(row%error(i)))
      end do
   end subroutine compare

   !> A flag where the reference is known: needless, unless its mechanism has been near a singularity, nothing
   !> was known of it, its motion is told to be too long, METHOD DENSE was to pass a change point, or one matrix has a
   !> group much smaller than others.
   subroutine judge_flag(s, m, group, row, is_too_long, so_far, v)
      type(scheme_t), intent(in) :: s
      type(motion_t), intent(in) :: m
      integer, intent(in) :: group(:)
      type(row_t), intent(in) :: row
      logical, intent(in) :: is_too_long
      type(so_far_t), intent(in) :: so_far
      type(verdict_t), intent(inout) :: v
      logical :: is_allowed

      is_allowed = s%method == 'MATRIX' .or. .not. is_regular(s, m, group, so_far%told)
      if (row%mark == 'NO-POSITION') is_allowed = is_allowed .or. is_too_long
      is_allowed = is_allowed .or. may_miss(s)
      if (is_allowed) then
         ! Digits that rounding has taken are masked; the instant is not flagged by that alone.
         if (row%mark /= 'UNKNOWN') v%flagged = v%flagged + 1
      else
         call blame(v%text, 'A NEEDLESS FLAG '//trim(row%mark)//': '//where(row))
      end if
   end subroutine judge_flag

   !> One matrix has groups of very different sizes.
   pure logical function may_miss(s)
      type(scheme_t), intent(in) :: s

      may_miss = (s%method == 'DENSE' .or. is_redundant(s)) &
         .and. minval(s%groups%scale) < small_group*maxval(s%groups%scale)
   end function may_miss

   !> No group of the mechanism of `group` has been near a singularity, and all errors were `told` (groups).
   pure logical function is_regular(s, m, group, told) result(is)
      type(scheme_t), intent(in) :: s
      type(motion_t), intent(in) :: m
      integer, intent(in) :: group(:)
      logical, intent(in) :: told(:)
      integer :: k

      is = .true.
      do k = 1, size(s%groups)
         if (s%groups(k)%part /= s%groups(maxval(group))%part) cycle
         is = is .and. told(k) .and. m%status(k) == is_followed .and. m%lowest(k) > safe_margin
         if (s%groups(k)%form == form_parallelogram) is = is .and. s%method /= 'DENSE' &
            .and. abs(m%sine(k)%v) > beside_change .and. .not. m%was_open(k)
      end do
   end function is_regular

   !> The groups that give the row its numbers, 0 for the ground.
   function groups_of(s, row) result(group)
      type(scheme_t), intent(in) :: s
      type(row_t), intent(in) :: row
      integer, allocatable :: group(:)

      select case (row%kind)
      case ('L')
         group = [s%links(row%number)%group]
      case ('P')
         group = [s%links(s%points(row%number)%link)%group]
      case ('M')
         group = s%links(links_of(row%number))%group
      case default
         group = s%links(link_at_each(s%pairs(row%number)%point_i, s%pairs(row%number)%point_j))%group
      end select

   contains

      pure function link_at_each(i, j) result(links)
         integer, intent(in) :: i, j
         integer :: links(2)

         links = [link_at(s, i), link_at(s, j)]
      end function link_at_each

      !> The links of measure number `k`.
      pure recursive function links_of(k) result(links)
         integer, intent(in) :: k
         integer, allocatable :: links(:)
         integer :: i

         allocate (links(0))
         associate (one => s%measures(k))
            do i = 1, 2
               if (one%kind == measure_sum .or. one%of_line(i)) then
                  links = [links, links_of(one%subjects(i))]
               else if (one%kind == measure_angle .or. (one%kind >= measure_xi .and. i == 2)) then
                  links = [links, one%subjects(i)]
               else
                  links = [links, link_at(s, one%subjects(i))]
               end if
            end do
         end associate
      end function links_of
   end function groups_of

   !> What the three columns of each derivative should be, in the deck's units.
   function true_values(s, m, row) result(reference)
      type(scheme_t), intent(in) :: s
      type(motion_t), intent(in) :: m
      type(row_t), intent(in) :: row
      type(jet_t) :: reference(3), d(2), theta
      real(qp) :: per_unit

      per_unit = 1.0_qp/angle_unit(s)
      select case (row%kind)
      case ('L')
         associate (b => m%b(row%number))
            reference = [b%x, b%y, per_unit*b%phi]
         end associate
      case ('P')
         reference(:2) = place(m%b(link_at(s, row%number)), s%points(row%number)%offset)
      case ('M')
         reference(3)%v = huge(1.0_qp)
         reference(1) = measured(row%number, reference(3)%v)
         if (s%measures(row%number)%is_angle) reference(1) = per_unit*reference(1)
      case default
         associate (pair => s%pairs(row%number))
            associate (i => m%b(link_at(s, pair%point_i)), j => m%b(link_at(s, pair%point_j)))
               reference(1) = per_unit*(j%phi - i%phi)
               if (.not. pair%prismatic) return
               d = place(j, s%points(pair%point_j)%offset) - place(i, s%points(pair%point_i)%offset)
               theta = i%phi + pair%alpha*angle_unit(s)
               reference(1) = d(1)*cos(theta) + d(2)*sin(theta)
            end associate
         end associate
      end select

   contains

      !> Measure number `k`, angles in rad. `distance`: 0 if two of its points are close.
      recursive function measured(k, distance) result(x)
         integer, intent(in) :: k
         real(qp), intent(inout) :: distance
         type(jet_t) :: x, one(2), way(2)
         integer :: i

         x = jet_t()
         associate (measure => s%measures(k), subjects => s%measures(k)%subjects)
            select case (measure%kind)
            case (measure_distance, measure_line)
               way = place(m%b(link_at(s, subjects(2))), s%points(subjects(2))%offset) &
                  - place(m%b(link_at(s, subjects(1))), s%points(subjects(1))%offset)
               if (hypot(way(1)%v, way(2)%v) < close*maxval(s%groups%scale)) then
                  distance = 0.0_qp
               else if (measure%kind == measure_distance) then
                  x = sqrt(way(1)*way(1) + way(2)*way(2))
               else
                  x = atan2(way(2), way(1))
               end if
            case (measure_angle, measure_sum)
               do i = 1, 2
                  if (measure%kind == measure_sum .or. measure%of_line(i)) then
                     one(i) = measured(subjects(i), distance)
                  else
                     one(i) = m%b(subjects(i))%phi
                  end if
               end do
               x = one(2) - one(1)
               if (measure%kind == measure_sum) x = measure%factors(1)*one(1) + measure%factors(2)*one(2) &
                  + measure%constant*merge(angle_unit(s), 1.0_qp, measure%is_angle)
            case default
               associate (b => m%b(subjects(2)))
                  way = place(m%b(link_at(s, subjects(1))), s%points(subjects(1))%offset)
                  way = [way(1) - b%x, way(2) - b%y]
                  x = way(1)*b%c + way(2)*b%s
                  if (measure%kind > measure_xi) x = way(2)*b%c - way(1)*b%s
               end associate
            end select
         end associate
      end function measured
   end function true_values

   !> The next row; `at_end`: there is none.
   subroutine read_row(unit, row, at_end, v)
      integer, intent(in) :: unit
      type(row_t), intent(out) :: row
      logical, intent(out) :: at_end
      type(verdict_t), intent(inout) :: v
      character(700) :: line
      character(cell_length) :: cell(cells)
      integer :: status, k, n

      read (unit, '(a)', iostat=status) line
      at_end = status /= 0
      if (at_end) return
      call split(line, cell, n)
      if (n /= cells) call blame(v%text, 'CELLS OF A ROW: '//trim(line))
      if (n /= cells) return
      read (cell(1), *) row%set
      read (cell(2), *) row%step
      row%t = number(cell(3))
      row%kind = cell(5)(1:1)
      read (cell(5)(2:), *) row%number
      do k = 1, 9
         row%known(k) = cell(5 + k) /= ''
         if (.not. row%known(k)) cycle
         row%value(k) = number(cell(5 + k))
         row%is_told(k) = cell(15 + k) /= ''
         if (row%is_told(k)) row%error(k) = number(cell(15 + k))
      end do
      row%mark = cell(15)(:12)
   end subroutine read_row

   real(qp) function number(text)
      character(*), intent(in) :: text
      real(real64) :: x
      integer :: status

      x = 0.0_real64
      read (text, *, iostat=status) x
      number = x
   end function number

   function where(row) result(text)
      type(row_t), intent(in) :: row
      character(:), allocatable :: text
      character(60) :: buffer

      write (buffer, '(a,i0,a,i0,a,i0)') row%kind, row%number, ' SET ', row%set, ' STEP ', row%step
      text = trim(buffer)
   end function where

   function told(x) result(text)
      real(qp), intent(in) :: x
      character(:), allocatable :: text
      character(30) :: buffer

      write (buffer, '(es24.16e3)') x
      text = trim(adjustl(buffer))
   end function told
end module scheme_results
