!> The numbers on the cards of a mechanism: the position of each in `mechanism_t`, its name, its unit, and its value.
!> TOLER and VARY cards and estimates of errors give other values to these numbers.
!>
!> An address (`parameter_t`) is four integers: a change of the number or of the deck's units does not change the
!> address.
module parameters
   use kinds, only: wp, label_length
   use plane_vectors, only: pi, degree, direction, rotated, point_of
   use mechanism, only: mechanism_t, drive_t, parameter_t, parameter_link, parameter_point, parameter_joint, &
      parameter_pair, parameter_drive, parameter_knot, parameter_time, parameter_length, parameter_hole, &
      parameter_stroke, term_harmonic, term_power, term_table, term_kinds
   use scales, only: is_length
   use splines, only: new_spline
   use drawn_lengths, only: apply_lengths
   use names, only: drive_name
   use number_format, only: whole
   use drawn_values, only: complete_from_drawing, drawn_drive
   implicit none
   private
   public :: is_as_drawn, unit_t, takes_tolerance, parameter_name, parameter_unit, parameter_value, change_parameter, &
      set_parameter, set_table, angle_in_radians, minute_in, turns_a_minute

   !> The unit of a number on a card.
   type :: unit_t
      real(wp) :: factor = 1.0_wp                !< the unit in the units of `mechanism_t`
      real(wp) :: powers(2) = [1.0_wp, 0.0_wp]   !< exponents of length and of time in the unit
      character(2*label_length + 5) :: name = '' !< as text, in tables; '': without a unit
   end type unit_t

   !> The word for revolutions per minute on a DRIVE card.
   character(label_length), parameter :: turns_a_minute = 'RPM'
   !> The units of time with a known length: seconds, milliseconds, minutes, hours.
   character(3), parameter :: time_words(4) = ['S  ', 'MS ', 'MIN', 'H  ']
   !> A minute in each of these units of time.
   real(wp), parameter :: minutes(4) = [60.0_wp, 60.0e3_wp, 1.0_wp, 1.0_wp/60.0_wp]

   !> The words of the cards for their numbers R1 to R3, by the kind of the number.
   character(12), parameter :: number_words(3, parameter_link:parameter_drive) = reshape([character(12) :: &
      'X', 'Y', 'PHI', 'XI', 'ETA', '', 'X', 'Y', '', 'ALPHA', 'H', 'BETA', 'VALUE', 'RATE', 'ACCELERATION'], [3, 5])

contains

   !> Tells whether a number can have a tolerance. These numbers cannot: the estimates of moving links; the axes of a
   !> ground link on which JOINT cards place points; strokes of cylinders; the times of TIME and of a table; the
   !> exponent of a power.
   pure logical function takes_tolerance(m, number)
      type(mechanism_t), intent(in) :: m
      type(parameter_t), intent(in) :: number   !< its address

      takes_tolerance = .false.
      select case (number%kind)
      case (parameter_link)
         if (m%links(number%subject)%ground) takes_tolerance = .not. any(m%points%link == &
            number%subject .and. m%points%drawn)
      case (parameter_point:parameter_pair, parameter_length, parameter_hole)
         takes_tolerance = .true.
      case (parameter_drive)
         takes_tolerance = .true.
         if (number%term == 0) return
         associate (kind => term_kinds(m%drives(number%subject)%terms(number%term)%kind))
            takes_tolerance = kind%has_rows .or. number%place <= kind%inexact
         end associate
      end select
   end function takes_tolerance

   !> Names a number for tables and messages: its card, the name that the card defines, and the card's word for the
   !> number.
   pure function parameter_name(m, number) result(name)
      type(mechanism_t), intent(in) :: m
      type(parameter_t), intent(in) :: number   !< its address
      character(:), allocatable :: name

      associate (k => number%subject)
         select case (number%kind)
         case (parameter_link)
            name = trim(merge('GROUND', 'LINK  ', m%links(k)%ground))//' '//trim(m%links(k)%name)
         case (parameter_point)
            name = 'POINT '//trim(m%points(k)%name)
         case (parameter_joint)
            name = 'JOINT '//trim(m%points(k)%name)

         case (parameter_pair)
            name = trim(merge('SLOT ', 'PRISM', m%pairs(k)%pin > 0))//' '//trim(m%pairs(k)%name)
         case (parameter_hole)
            name = trim(m%points(k)%name)//' IN '//trim(m%links(m%points(k)%link)%name)//' ' &
               //trim(number_words(number%place, parameter_joint))
            return

         case (parameter_length)
            associate (one => m%lengths(k))
               name = trim('LENGTH '//trim(m%points(one%point(1))%name)//' '//trim(m%points(one%point(2))%name)//' ' &
                  //one%link)
            end associate
            return
         case (parameter_stroke)
            name = 'CYLINDER '//trim(m%pairs(k)%name)//' '//trim(merge('LEAST   ', 'GREATEST', number%place == 1))
            return
         case (parameter_time)
            name = 'TIME T'//whole(number%place - 1)
            if (number%place == 2 .and. m%turns > 0.0_wp) name = 'TIME TURNS'
            return
         case default
            name = trim(drive_name(m, m%drives(k)))
         end select

         if (number%term == 0) then
            name = name//' '//trim(number_words(number%place, number%kind))
            return
         end if
      end associate

      ! The word and the number of the term, and the card's word for the number.
      associate (kind => term_kinds(m%drives(number%subject)%terms(number%term)%kind))
         name = name//' '//trim(kind%word)//' '//whole(number%term)//' '
         if (kind%has_rows) then
            name = name//trim(merge('TIME', 'ROW ', number%kind == parameter_knot))//' '//whole(number%place)
         else
            name = name//trim(kind%numbers(number%place))
         end if
      end associate
   end function parameter_name

   !> Finds the unit of a number on its card.
   function parameter_unit(m, number) result(unit)
      type(mechanism_t), intent(in) :: m
      type(parameter_t), intent(in) :: number   !< its address
      type(unit_t) :: unit

      select case (number%kind)
      case (parameter_link)
         unit = unit_of(number%place == 3)
      case (parameter_point, parameter_joint, parameter_length, parameter_hole, parameter_stroke)
         unit = unit_of(.false.)
      case (parameter_pair)
         unit = unit_of(number%place /= 2)
      case (parameter_drive)
         unit = unit_of(.not. is_length(m%drives(number%subject)))
         if (number%term == 0) then
            if (number%place > 1) call divide(real(number%place - 1, wp), merge('**2', '   ', number%place == 3))
            if (number%place == 2 .and. m%drives(number%subject)%turns) &
               unit = unit_t(2.0_wp*pi/minute_in(m%time_unit), unit%powers, turns_a_minute)
            return
         end if

         associate (term => m%drives(number%subject)%terms(number%term))
            select case (term%kind)
            case (term_harmonic)
               if (number%place > 1) unit = unit_of(.true.)
               if (number%place == 2) call divide(1.0_wp, '')
            case (term_power)
               if (number%place == 1) call divide(term%r(2), '**R2')
               if (number%place == 2) unit = unit_t(powers=[0.0_wp, 0.0_wp])
            case (term_table)
               ! A row has the unit of the drive.
            case default
               if (number%place < 3) unit = unit_t(powers=[0.0_wp, 1.0_wp], name=m%time_unit)
            end select
         end associate
      case default
         unit = unit_t(powers=[0.0_wp, 1.0_wp], name=m%time_unit)
         if (number%kind == parameter_time .and. number%place == 2 .and. m%turns > 0.0_wp) unit = unit_t(powers=0.0_wp)
      end select

   contains

      !> Gives the deck's unit of angles or of lengths.
      pure type(unit_t) function unit_of(is_angle) result(one)
         logical, intent(in) :: is_angle     !< of angles; otherwise of lengths

         one = unit_t(name=m%length_unit)
         if (is_angle) one = unit_t(angle_in_radians(m), [0.0_wp, 0.0_wp], merge('DEG', 'RAD', m%degrees))
      end function unit_of

      !> Divides `unit` by a power of the deck's unit of time.
      subroutine divide(power, end_of_name)
         real(wp), intent(in) :: power       !< the exponent
         character(*), intent(in) :: end_of_name   !< the exponent as text: '**2'; '' for 1

         unit%powers(2) = -power
         unit%name = trim(unit%name)//'/'//trim(m%time_unit)//end_of_name
      end subroutine divide
   end function parameter_unit

   !> Gives the value of a number, in the units of `mechanism_t`. For a JOINT card or a hole the value is a coordinate
   !> in the drawing.
   real(wp) function parameter_value(m, number) result(value)
      type(mechanism_t), intent(in), target :: m
      type(parameter_t), intent(in) :: number   !< its address
      real(wp), pointer :: x
      real(wp) :: position(2)

      x => number_in(m, number)
      value = x
      if (all(number%kind /= [parameter_joint, parameter_hole])) return
      position = point_of(m%links(m%points(number%subject)%link)%position, m%points(number%subject)%offset)
      value = position(number%place)
   end function parameter_value

   !> Points to the component of a mechanism that holds a number; for a JOINT card, to xi or eta of its first point.
   function number_in(m, number) result(x)
      type(mechanism_t), intent(in), target :: m
      type(parameter_t), intent(in) :: number   !< its address
      real(wp), pointer :: x

      associate (k => number%subject, i => number%place)
         select case (number%kind)
         case (parameter_link)
            x => m%links(k)%position(i)
         case (parameter_point, parameter_joint, parameter_hole)
            x => m%points(k)%offset(i)
         case (parameter_pair)
            x => m%pairs(k)%alpha
            if (i == 2) x => m%pairs(k)%offset
            if (i == 3) x => m%pairs(k)%beta

         case (parameter_length)
            x => m%lengths(k)%length
         case (parameter_stroke)
            x => m%pairs(k)%stroke(i)

         case (parameter_knot)
            x => m%drives(k)%terms(number%term)%table%x(i)
         case (parameter_time)
            x => m%t0
            if (i == 2) x => m%t1
            if (i == 2 .and. m%turns > 0.0_wp) x => m%turns
         case default
            if (number%term == 0) then
               x => m%drives(k)%polynomial(i)
            else if (term_kinds(m%drives(k)%terms(number%term)%kind)%has_rows) then
               x => m%drives(k)%terms(number%term)%table%y(i)
            else
               x => m%drives(k)%terms(number%term)%r(i)
            end if
         end select
      end associate
   end function number_in

   !> Changes a number to a value, and all numbers that depend on it. Other numbers as drawn follow the drawing. Points
   !> follow a length; numbers as drawn follow neither a length nor the hole of one link.
   subroutine change_parameter(m, number, value)
      type(mechanism_t), intent(inout) :: m  !< with its links at the positions of the cards
      type(parameter_t), intent(in) :: number   !< its address
      real(wp), intent(in) :: value          !< in the units of `mechanism_t`
      logical :: again

      call set_parameter(m, number, value)
      ! As in a drawing with other coordinates, lengths and axes along bars are applied again.
      again = allocated(m%lengths) .and. (number%kind <= parameter_joint .or. number%kind == parameter_length) &
         .or. number%kind == parameter_joint .and. any(m%links%from > 0)
      ! A point that lengths have moved is off from where it is now.
      if (number%kind == parameter_point) again = again .and. .not. m%points(number%subject)%moves
      if (again) call apply_lengths(m)
      if (any(number%kind == [parameter_drive, parameter_knot])) call set_table(m%drives(number%subject), number%term)
      if (number%kind > parameter_pair) return
      call follow_drawing(m)
      ! The number itself may have been as drawn.
      if (number%kind == parameter_pair) call set_parameter(m, number, value)
   end subroutine change_parameter

   !> Changes a number to a value, and no other number. A coordinate of a JOINT card moves both points of the joint, the
   !> coordinate of a hole one of them; all points of their holes move as well. After all changes of the numbers of a
   !> table, `set_table` must be called.
   subroutine set_parameter(m, number, value)
      type(mechanism_t), intent(inout), target :: m
      type(parameter_t), intent(in) :: number   !< its address
      real(wp), intent(in) :: value          !< in the units of `mechanism_t`
      real(wp), pointer :: x
      real(wp) :: way(2)
      integer :: i, j

      if (all(number%kind /= [parameter_joint, parameter_hole])) then
         x => number_in(m, number)
         x = value
         return
      end if
      way = 0.0_wp
      way(number%place) = value - parameter_value(m, number)
      do i = number%subject, min(size(m%points), number%subject + merge(1, 0, number%kind == parameter_joint))
         ! A part of a divided set may have one point of a joint alone.
         if (m%points(i)%name /= m%points(number%subject)%name) cycle
         do j = 1, size(m%points)
            if (j /= i .and. (m%points(j)%hole == 0 .or. m%points(j)%hole /= m%points(i)%hole)) cycle
            associate (point => m%points(j), own => rotated(way, direction(-m%links(m%points(j)%link)%position(3))))
               point%offset = point%offset + own
               if (number%kind == parameter_joint) point%place = point%place + merge(way, own, point%drawn)
            end associate
         end do
      end do
   end subroutine set_parameter

   !> Computes the spline of a term from its rows, if the term is a table.
   subroutine set_table(drive, term)
      type(drive_t), intent(inout) :: drive  !< the drive that has the term
      integer, intent(in) :: term            !< number of the term; 0: none, nothing is done

      if (term == 0) return
      associate (one => drive%terms(term))
         if (term_kinds(one%kind)%has_rows) one%table = new_spline(one%table%x, one%table%y)
      end associate
   end subroutine set_table

   !> Gives the unit of angles on the cards, in rad: 1 or a degree.
   pure real(wp) function angle_in_radians(m)
      type(mechanism_t), intent(in) :: m

      angle_in_radians = merge(degree, 1.0_wp, m%degrees)
   end function angle_in_radians

   !> Gives the length of a minute in a unit of time; 0 if the unit is not known.
   pure real(wp) function minute_in(time_unit)
      character(label_length), intent(in) :: time_unit   !< of the deck; S, MS, MIN and H are known
      integer :: i

      i = findloc(time_words, time_unit, dim=1)
      minute_in = 0.0_wp
      if (i > 0) minute_in = minutes(i)
   end function minute_in

   !> Changes all numbers that are as drawn to the values of the drawing, as it is before lengths move its points.
   pure subroutine follow_drawing(m)
      type(mechanism_t), intent(inout) :: m
      type(mechanism_t), allocatable :: drawing
      integer :: i

      if (.not. (any(m%drives%drawn) .or. any(m%pairs%drawn(1) .or. m%pairs%drawn(2) .or. m%pairs%drawn(3)))) return
      drawing = m
      if (allocated(m%lengths)) then
         deallocate (drawing%lengths)
         call apply_lengths(drawing)
      end if
      do i = 1, size(m%pairs)
         if (any(m%pairs(i)%drawn) .or. m%pairs(i)%pin > 0) call complete_from_drawing(drawing, i)
      end do
      m%pairs = drawing%pairs
      do i = 1, size(m%drives)
         if (m%drives(i)%drawn) m%drives(i)%polynomial(1) = drawn_drive(drawing, drawing%drives(i))
      end do
   end subroutine follow_drawing

   !> Tells whether the drawing gives the value of a number: the number is blank on its card, in a deck with JOINT
   !> cards.
   pure logical function is_as_drawn(m, number)
      type(mechanism_t), intent(in) :: m
      type(parameter_t), intent(in) :: number   !< its address

      is_as_drawn = .false.
      if (number%kind == parameter_pair) is_as_drawn = m%pairs(number%subject)%drawn(number%place)
      if (number%kind == parameter_drive .and. number%term == 0 .and. number%place == 1) is_as_drawn = &
         m%drives(number%subject)%drawn
   end function is_as_drawn
end module parameters
